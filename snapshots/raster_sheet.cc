#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "snapshots/sheet.h"

namespace regrasp {
namespace {

constexpr int kShift = 4;  // fractional bits of OpenCV's drawing coordinates

cv::Scalar Bgr(Colour c) { return {double(c.b), double(c.g), double(c.r)}; }

/// Full path of a DejaVu font file, or throws.
std::string FindFont(const std::string& file, const std::string& picture) {
  std::vector<std::filesystem::path> folders;
  if (const char* dir = std::getenv("REGRASP_FONT_DIR")) folders.emplace_back(dir);
  for (const char* dir : {"/usr/share/fonts/truetype/dejavu", "/usr/share/fonts/dejavu",
                          "/usr/share/fonts/TTF", "/usr/local/share/fonts"})
    folders.emplace_back(dir);
  for (const auto& folder : folders) {
    std::error_code ignored;
    if (std::filesystem::exists(folder / file, ignored)) return (folder / file).string();
  }
  throw std::runtime_error(
      fmt::format("{}: font {} not found in {} (install the package fonts-dejavu-core, or set "
                  "REGRASP_FONT_DIR)",
                  picture, file, folders.front().string()));
}

cv::Ptr<cv::freetype::FreeType2> LoadFont(const std::string& file, const std::string& picture) {
  auto font = cv::freetype::createFreeType2();
  font->loadFontData(FindFont(file, picture), 0);
  return font;
}

/// A PNG with its printed size (chunk pHYs, after the header of 33 bytes).
void AddPhysicalSize(std::vector<std::uint8_t>* png, const SheetSize& size) {
  const auto per_metre =
      static_cast<std::uint32_t>(std::lround(size.width_px / (size.width_mm * 1e-3)));
  std::vector<std::uint8_t> chunk = {0, 0, 0, 9, 'p', 'H', 'Y', 's'};
  const auto add = [&chunk](std::uint32_t v) {
    for (int shift = 24; shift >= 0; shift -= 8)
      chunk.push_back(static_cast<std::uint8_t>(v >> shift));
  };
  add(per_metre);
  add(per_metre);
  chunk.push_back(1);  // the unit is the metre
  add(static_cast<std::uint32_t>(crc32(0, chunk.data() + 4, 13)));
  png->insert(png->begin() + 33, chunk.begin(), chunk.end());
}

class RasterSheet final : public Sheet {
 public:
  RasterSheet(const SheetSize& size, const Fonts& fonts)
      : size_(size),
        scale_(size.unit * kOversampling),
        image_(size.height_px * kOversampling, size.width_px * kOversampling, CV_8UC3),
        target_(image_),
        fonts_(fonts) {
    std::memset(image_.data, 255, image_.total() * image_.elemSize());  // white
  }

  void Clip(const Box& box) override;
  void Unclip() override;
  void Stroke(std::span<const Point2> points, Colour colour, double width) override;
  void Polygon(std::span<const Point2> corners, Colour fill) override;
  void FillBox(const Box& box, Colour fill) override;
  void Disc(Point2 centre, double radius, Colour fill) override;
  void Circle(Point2 centre, double radius, Colour colour, double width) override;
  void Text(Point2 at, const std::string& utf8, const TextStyle& style) override;
  void Paste(const cv::Mat& bgr, const Box& box) override;
  std::string Bytes() override;

 private:
  cv::Point Fixed(Point2 p) const;
  int Thickness(double width) const;
  void Blend(const cv::Mat& mask, cv::Point corner, Colour colour);

  SheetSize size_;
  double scale_;
  cv::Mat image_, target_;
  cv::Point origin_{0, 0};
  Fonts fonts_;
};

void RasterSheet::Clip(const Box& box) {
  const cv::Point a(std::lround(box.x * scale_), std::lround(box.y * scale_));
  const cv::Point b(std::lround(box.br().x * scale_), std::lround(box.br().y * scale_));
  const cv::Rect inside = cv::Rect(a, b) & cv::Rect(0, 0, image_.cols, image_.rows);
  target_ = image_(inside);
  origin_ = inside.tl();
}

void RasterSheet::Unclip() {
  target_ = image_;
  origin_ = {0, 0};
}

cv::Point RasterSheet::Fixed(Point2 p) const {
  // A logical coordinate is a position on the sheet; pixel k covers [k, k+1), its centre is drawn
  // at k.
  const auto fix = [this](double v, int origin) {
    const double px = std::clamp(v * scale_ - 0.5 - origin, -60000.0, 60000.0);
    return static_cast<int>(std::lround(px * (1 << kShift)));
  };
  return {fix(p.x, origin_.x), fix(p.y, origin_.y)};
}

int RasterSheet::Thickness(double width) const {
  return std::max(1, static_cast<int>(std::lround(width * scale_)));
}

void RasterSheet::Stroke(std::span<const Point2> points, Colour colour, double width) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const Point2& p : points) fixed.push_back(Fixed(p));
  if (fixed.size() == 1) fixed.push_back(fixed.front());
  cv::polylines(target_, fixed, false, Bgr(colour), Thickness(width), cv::LINE_AA, kShift);
}

void RasterSheet::Polygon(std::span<const Point2> corners, Colour fill) {
  std::vector<cv::Point> fixed;
  for (const Point2& p : corners) fixed.push_back(Fixed(p));
  cv::fillPoly(target_, fixed, Bgr(fill), cv::LINE_AA, kShift);
}

void RasterSheet::FillBox(const Box& box, Colour fill) {
  const cv::Point a(std::lround(box.x * scale_) - origin_.x,
                    std::lround(box.y * scale_) - origin_.y);
  const cv::Point b(std::lround(box.br().x * scale_) - origin_.x,
                    std::lround(box.br().y * scale_) - origin_.y);
  const cv::Rect inside = cv::Rect(a, b) & cv::Rect(0, 0, target_.cols, target_.rows);
  if (inside.area() > 0) target_(inside).setTo(Bgr(fill));
}

void RasterSheet::Disc(Point2 centre, double radius, Colour fill) {
  cv::circle(target_, Fixed(centre), static_cast<int>(std::lround(radius * scale_ * (1 << kShift))),
             Bgr(fill), cv::FILLED, cv::LINE_AA, kShift);
}

void RasterSheet::Circle(Point2 centre, double radius, Colour colour, double width) {
  cv::circle(target_, Fixed(centre), static_cast<int>(std::lround(radius * scale_ * (1 << kShift))),
             Bgr(colour), Thickness(width), cv::LINE_AA, kShift);
}

void RasterSheet::Text(Point2 at, const std::string& utf8, const TextStyle& style) {
  if (utf8.empty()) return;
  const int em = std::max(4, static_cast<int>(std::lround(style.size * scale_)));
  const auto& font = style.bold ? fonts_.bold : fonts_.regular;
  int below = 0;
  const int width = font->getTextSize(utf8, em, -1, &below).width;
  // The glyphs are drawn white on black with room around them; what comes out is their coverage.
  const int margin = em / 2, rise = em + margin;
  cv::Mat glyphs(2 * em + margin, width + 2 * margin, CV_8UC3, cv::Scalar::all(0));
  font->putText(glyphs, utf8, {margin, rise}, em, cv::Scalar::all(255), -1, cv::LINE_AA, true);
  cv::Mat coverage;
  cv::extractChannel(glyphs, coverage, 0);

  double lift = 0;
  if (style.align_y == AlignY::kMiddle) lift = kMiddleOfLine * em;
  if (style.align_y == AlignY::kTop) lift = kTopOfLine * em;
  double back = 0;
  if (style.align_x == AlignX::kCentre) back = width / 2.0;
  if (style.align_x == AlignX::kRight) back = width;
  const double anchor_x = margin + back, anchor_y = rise - lift;
  cv::Point corner(std::lround(at.x * scale_ - anchor_x), std::lround(at.y * scale_ - anchor_y));
  if (style.upwards) {
    cv::rotate(coverage, coverage, cv::ROTATE_90_COUNTERCLOCKWISE);
    // (x, y) of the upright mask went to (y, columns - x).
    corner = {static_cast<int>(std::lround(at.x * scale_ - anchor_y)),
              static_cast<int>(std::lround(at.y * scale_ - (glyphs.cols - anchor_x)))};
  }
  if (style.halo > 0) {
    const int r = std::max(1, static_cast<int>(std::lround(style.halo * scale_)));
    cv::Mat wide;
    cv::dilate(coverage, wide,
               cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1}));
    Blend(wide, corner, kWhite);
  }
  Blend(coverage, corner, style.colour);
}

/// `mask`: coverage 0..255, its upper left pixel at `corner` of the whole sheet.
void RasterSheet::Blend(const cv::Mat& mask, cv::Point corner, Colour colour) {
  const cv::Rect whole(corner - origin_, mask.size());
  const cv::Rect inside = whole & cv::Rect(0, 0, target_.cols, target_.rows);
  for (int y = 0; y < inside.height; ++y) {
    const auto* a = mask.ptr<std::uint8_t>(inside.y - whole.y + y) + (inside.x - whole.x);
    auto* out = target_.ptr<cv::Vec3b>(inside.y + y) + inside.x;
    for (int x = 0; x < inside.width; ++x) {
      if (a[x] == 0) continue;
      const int w = a[x];
      out[x][0] = static_cast<std::uint8_t>((out[x][0] * (255 - w) + colour.b * w + 127) / 255);
      out[x][1] = static_cast<std::uint8_t>((out[x][1] * (255 - w) + colour.g * w + 127) / 255);
      out[x][2] = static_cast<std::uint8_t>((out[x][2] * (255 - w) + colour.r * w + 127) / 255);
    }
  }
}

void RasterSheet::Paste(const cv::Mat& bgr, const Box& box) {
  const cv::Rect where(cv::Point(std::lround(box.x * scale_), std::lround(box.y * scale_)),
                       bgr.size());
  const cv::Rect inside = where & cv::Rect(0, 0, image_.cols, image_.rows);
  if (inside.area() > 0) bgr(inside - where.tl()).copyTo(image_(inside));
}

std::string RasterSheet::Bytes() {
  cv::Mat small;
  cv::resize(image_, small, {size_.width_px, size_.height_px}, 0, 0, cv::INTER_AREA);
  if (size_.suffix == kPixels)
    return {reinterpret_cast<const char*>(small.data), small.total() * small.elemSize()};
  std::vector<std::uint8_t> bytes;
  const std::vector<int> settings = {cv::IMWRITE_PNG_COMPRESSION, 3, cv::IMWRITE_JPEG_QUALITY, 94};
  if (!cv::imencode(size_.suffix, small, bytes, settings))
    throw std::runtime_error("cannot encode the picture");
  if (size_.suffix == ".png") AddPhysicalSize(&bytes, size_);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Fonts::Fonts(const std::string& picture)
    : regular(LoadFont("DejaVuSans.ttf", picture)),
      bold(LoadFont("DejaVuSans-Bold.ttf", picture)) {}

std::unique_ptr<Sheet> MakeRasterSheet(const SheetSize& size, const Fonts& fonts) {
  return std::make_unique<RasterSheet>(size, fonts);
}

}  // namespace regrasp
