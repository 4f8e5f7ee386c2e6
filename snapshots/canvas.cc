#include "snapshots/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace regrasp {
namespace {

constexpr int kShift = 4;  // fractional bits of OpenCV's drawing coordinates
constexpr std::array<const char*, 3> kSuffixes = {".png", ".jpg", ".jpeg"};

cv::Scalar Bgr(Colour c) { return {double(c.b), double(c.g), double(c.r)}; }

std::string LowerSuffix(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

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

}  // namespace

Canvas::Canvas(int width_px, int height_px, std::string path)
    : path_(std::move(path)), width_px_(width_px), height_px_(height_px) {
  if (std::find(kSuffixes.begin(), kSuffixes.end(), LowerSuffix(path_)) == kSuffixes.end())
    throw std::runtime_error(fmt::format("{}: unsupported suffix '{}' (allowed: .png, .jpg, .jpeg)",
                                         path_, LowerSuffix(path_)));
  if (width_px < 400 || width_px > 8000 || height_px < 300 || height_px > 8000)
    throw std::runtime_error(fmt::format(
        "{}: picture size {}x{} px (allowed: 400x300 .. 8000x8000)", path_, width_px, height_px));
  unit_ = std::min(width_px / 1600.0, height_px / 1000.0);
  scale_ = unit_ * kOversampling;
  image_ =
      cv::Mat(height_px * kOversampling, width_px * kOversampling, CV_8UC3, cv::Scalar::all(255));
  target_ = image_;
  regular_ = LoadFont("DejaVuSans.ttf", path_);
  bold_ = LoadFont("DejaVuSans-Bold.ttf", path_);
}

void Canvas::Clip(const Box& box) {
  const cv::Point a(std::lround(box.x * scale_), std::lround(box.y * scale_));
  const cv::Point b(std::lround(box.br().x * scale_), std::lround(box.br().y * scale_));
  const cv::Rect inside = cv::Rect(a, b) & cv::Rect(0, 0, image_.cols, image_.rows);
  target_ = image_(inside);
  origin_ = inside.tl();
}

void Canvas::Unclip() {
  target_ = image_;
  origin_ = {0, 0};
}

cv::Point Canvas::Fixed(Point2 p) const {
  // A logical coordinate is a position on the sheet; pixel k covers [k, k+1), its centre is drawn
  // at k.
  const auto fix = [this](double v, int origin) {
    const double px = std::clamp(v * scale_ - 0.5 - origin, -60000.0, 60000.0);
    return static_cast<int>(std::lround(px * (1 << kShift)));
  };
  return {fix(p.x, origin_.x), fix(p.y, origin_.y)};
}

int Canvas::Thickness(double width) const {
  return std::max(1, static_cast<int>(std::lround(width * scale_)));
}

void Canvas::Stroke(std::span<const Point2> points, const Pen& pen) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const Point2& p : points) fixed.push_back(Fixed(p));
  if (fixed.size() == 1) fixed.push_back(fixed.front());
  cv::polylines(target_, fixed, false, Bgr(pen.colour), Thickness(pen.width), cv::LINE_AA, kShift);
}

void Canvas::Polyline(std::span<const Point2> points, const Pen& pen) {
  if (points.empty()) return;
  if (pen.dash.empty()) return Stroke(points, pen);
  std::size_t k = 0;
  double left = pen.dash[0];
  bool on = true;
  std::vector<Point2> stroke = {points[0]};
  for (std::size_t i = 1; i < points.size(); ++i) {
    Point2 from = points[i - 1];
    double length = cv::norm(points[i] - from);
    while (length > left) {
      from += (points[i] - from) * (left / length);
      length -= left;
      if (on) {
        stroke.push_back(from);
        Stroke(stroke, pen);
      }
      stroke = {from};
      on = !on;
      k = (k + 1) % pen.dash.size();
      left = pen.dash[k];
    }
    left -= length;
    if (on) stroke.push_back(points[i]);
  }
  if (on && stroke.size() > 1) Stroke(stroke, pen);
}

void Canvas::Line(Point2 a, Point2 b, const Pen& pen) {
  const std::array<Point2, 2> ends = {a, b};
  Polyline(ends, pen);
}

void Canvas::Polygon(std::span<const Point2> corners, Colour fill) {
  std::vector<cv::Point> fixed;
  for (const Point2& p : corners) fixed.push_back(Fixed(p));
  cv::fillPoly(target_, fixed, Bgr(fill), cv::LINE_AA, kShift);
}

void Canvas::FillBox(const Box& box, Colour fill) {
  const cv::Point a(std::lround(box.x * scale_) - origin_.x,
                    std::lround(box.y * scale_) - origin_.y);
  const cv::Point b(std::lround(box.br().x * scale_) - origin_.x,
                    std::lround(box.br().y * scale_) - origin_.y);
  const cv::Rect inside = cv::Rect(a, b) & cv::Rect(0, 0, target_.cols, target_.rows);
  if (inside.area() > 0) target_(inside).setTo(Bgr(fill));
}

void Canvas::Disc(Point2 centre, double radius, Colour fill) {
  cv::circle(target_, Fixed(centre), static_cast<int>(std::lround(radius * scale_ * (1 << kShift))),
             Bgr(fill), cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::Circle(Point2 centre, double radius, const Pen& pen) {
  if (!pen.dash.empty()) {
    std::vector<Point2> points;
    for (int i = 0; i <= 180; ++i) {
      const double a = i * std::numbers::pi / 90;
      points.push_back(centre + Point2(std::cos(a), std::sin(a)) * radius);
    }
    return Polyline(points, pen);
  }
  cv::circle(target_, Fixed(centre), static_cast<int>(std::lround(radius * scale_ * (1 << kShift))),
             Bgr(pen.colour), Thickness(pen.width), cv::LINE_AA, kShift);
}

void Canvas::Mark(Marker marker, Point2 centre, double radius, Colour colour, Colour inside) {
  const auto ring = [&](int corners, double start_deg, double size) {
    std::vector<Point2> points;
    for (int i = 0; i < corners; ++i) {
      const double a = (start_deg + 360.0 * i / corners) * std::numbers::pi / 180;
      points.push_back(centre + Point2(std::cos(a), std::sin(a)) * (radius * size));
    }
    return points;
  };
  const Pen rim{colour, std::max(0.8, radius * 0.3)};
  const auto shape = [&](std::vector<Point2> points) {
    Polygon(points, inside);
    points.push_back(points.front());
    Polyline(points, rim);
  };
  switch (marker) {
    case Marker::kDisc:
      Disc(centre, radius, inside);
      Circle(centre, radius, rim);
      break;
    case Marker::kSquare:
      shape(ring(4, 45, 1.25));
      break;
    case Marker::kDiamond:
      shape(ring(4, 0, 1.35));
      break;
    case Marker::kUp:
      shape(ring(3, -90, 1.35));
      break;
    case Marker::kDown:
      shape(ring(3, 90, 1.35));
      break;
    case Marker::kStar: {
      std::vector<Point2> points;
      for (int i = 0; i < 10; ++i) {
        const double a = (-90 + 36 * i) * std::numbers::pi / 180;
        points.push_back(centre +
                         Point2(std::cos(a), std::sin(a)) * (radius * (i % 2 ? 0.6 : 1.5)));
      }
      shape(points);
      break;
    }
    case Marker::kCross:
    case Marker::kPlus: {
      const std::vector<Point2> ends = ring(4, marker == Marker::kCross ? 45 : 0, 1.2);
      const Pen stroke{colour, std::max(1.2, radius * 0.55)};
      Line(ends[0], ends[2], stroke);
      Line(ends[1], ends[3], stroke);
      break;
    }
  }
}

void Canvas::Arrow(Point2 tail, Point2 head, const Pen& pen, double halo) {
  const double length = cv::norm(head - tail);
  if (length < 1e-6) return;
  const Point2 along = (head - tail) * (1.0 / length), across(-along.y, along.x);
  const double tip = std::min(4.2 * pen.width, 0.6 * length);
  const auto draw = [&](Colour colour, double grow) {
    const Point2 base = head - along * tip;
    const double half = 0.42 * tip + 0.8 * grow;
    const std::array<Point2, 3> corners = {head + along * (1.6 * grow),
                                           base - along * (0.5 * grow) + across * half,
                                           base - along * (0.5 * grow) - across * half};
    Line(tail, base, {colour, pen.width + 2 * grow, pen.dash});
    Polygon(corners, colour);
  };
  if (halo > 0) draw(kWhite, halo);
  draw(pen.colour, 0);
}

double Canvas::TextWidth(const std::string& utf8, double size, bool bold) {
  int baseline = 0;
  const int em = std::max(4, static_cast<int>(std::lround(size * scale_)));
  return (bold ? bold_ : regular_)->getTextSize(utf8, em, -1, &baseline).width / scale_;
}

void Canvas::Text(Point2 at, const std::string& utf8, const TextStyle& style) {
  if (utf8.empty()) return;
  const int em = std::max(4, static_cast<int>(std::lround(style.size * scale_)));
  auto& font = style.bold ? bold_ : regular_;
  int below = 0;
  const int width = font->getTextSize(utf8, em, -1, &below).width;
  // The glyphs are drawn white on black with room around them; what comes out is their coverage.
  const int margin = em / 2, rise = em + margin;
  cv::Mat glyphs(2 * em + margin, width + 2 * margin, CV_8UC3, cv::Scalar::all(0));
  font->putText(glyphs, utf8, {margin, rise}, em, cv::Scalar::all(255), -1, cv::LINE_AA, true);
  cv::Mat coverage;
  cv::extractChannel(glyphs, coverage, 0);

  // DejaVu: capitals are 0.73 em high, so the middle of a line lies 0.365 em above its baseline.
  double lift = 0;
  if (style.align_y == AlignY::kMiddle) lift = 0.355 * em;
  if (style.align_y == AlignY::kTop) lift = 0.76 * em;
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
  corner -= origin_;
  const cv::Rect whole(corner, coverage.size());
  const cv::Rect inside = whole & cv::Rect(0, 0, target_.cols, target_.rows);
  if (inside.area() == 0) return;
  const auto blend = [&](const cv::Mat& mask, Colour colour) {
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
  };
  if (style.halo > 0) {
    const int r = std::max(1, static_cast<int>(std::lround(style.halo * scale_)));
    cv::Mat wide;
    cv::dilate(coverage, wide,
               cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1}));
    blend(wide, kWhite);
  }
  blend(coverage, style.colour);
}

cv::Size Canvas::PixelsOf(const Box& box) const {
  return {static_cast<int>(std::lround(box.width * scale_)),
          static_cast<int>(std::lround(box.height * scale_))};
}

void Canvas::Paste(const cv::Mat& bgr, const Box& box) {
  const cv::Rect where(cv::Point(std::lround(box.x * scale_), std::lround(box.y * scale_)),
                       bgr.size());
  const cv::Rect inside = where & cv::Rect(0, 0, image_.cols, image_.rows);
  if (inside.area() > 0) bgr(inside - where.tl()).copyTo(image_(inside));
}

cv::Mat Canvas::Finish() const {
  cv::Mat small;
  cv::resize(image_, small, {width_px_, height_px_}, 0, 0, cv::INTER_AREA);
  return small;
}

void Canvas::Save() const {
  std::vector<std::uint8_t> bytes;
  const std::vector<int> settings = {cv::IMWRITE_PNG_COMPRESSION, 3, cv::IMWRITE_JPEG_QUALITY, 94};
  if (!cv::imencode(LowerSuffix(path_), Finish(), bytes, settings))
    throw std::runtime_error(path_ + ": cannot encode the picture");
  std::FILE* file = std::fopen(path_.c_str(), "wb");
  if (!file)
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path_, std::strerror(errno)));
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const int error = errno;
  if (std::fclose(file) != 0 || !written) {
    std::remove(path_.c_str());
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path_, std::strerror(error)));
  }
}

}  // namespace regrasp
