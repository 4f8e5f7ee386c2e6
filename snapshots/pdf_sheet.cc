#include <cairo-pdf.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "snapshots/sheet.h"

namespace regrasp {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;

cairo_status_t Append(void* to, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

class PdfSheet final : public Sheet {
 public:
  explicit PdfSheet(const SheetSize& size) {
    const double width = size.width_mm * kPointsPerMm;
    const double scale = width / size.width_px;
    surface_ = cairo_pdf_surface_create_for_stream(Append, &bytes_, width, size.height_px * scale);
    // No dates: the same run gives the same file.
    cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_CREATE_DATE, "");
    cairo_ = cairo_create(surface_);
    cairo_scale(cairo_, scale * size.unit, scale * size.unit);
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  }
  PdfSheet(const PdfSheet&) = delete;
  PdfSheet& operator=(const PdfSheet&) = delete;
  ~PdfSheet() override {
    cairo_destroy(cairo_);
    cairo_surface_destroy(surface_);
  }

  void Clip(const Box& box) override {
    Unclip();
    cairo_rectangle(cairo_, box.x, box.y, box.width, box.height);
    cairo_clip(cairo_);
  }
  void Unclip() override { cairo_reset_clip(cairo_); }

  void Stroke(std::span<const Point2> points, Colour colour, double width) override {
    Path(points);
    Ink(colour);
    cairo_set_line_width(cairo_, width);
    cairo_stroke(cairo_);
  }
  void Polygon(std::span<const Point2> corners, Colour fill) override {
    Path(corners);
    cairo_close_path(cairo_);
    Ink(fill);
    cairo_fill(cairo_);
  }
  void FillBox(const Box& box, Colour fill) override {
    Ink(fill);
    cairo_rectangle(cairo_, box.x, box.y, box.width, box.height);
    cairo_fill(cairo_);
  }
  void Disc(Point2 centre, double radius, Colour fill) override {
    Ink(fill);
    cairo_new_path(cairo_);
    cairo_arc(cairo_, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(cairo_);
  }
  void Circle(Point2 centre, double radius, Colour colour, double width) override {
    Ink(colour);
    cairo_set_line_width(cairo_, width);
    cairo_new_path(cairo_);
    cairo_arc(cairo_, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo_stroke(cairo_);
  }

  void Text(Point2 at, const std::string& utf8, const TextStyle& style) override {
    cairo_save(cairo_);
    cairo_select_font_face(cairo_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo_, style.size);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_, utf8.c_str(), &extents);
    cairo_translate(cairo_, at.x, at.y);
    if (style.upwards) cairo_rotate(cairo_, -std::numbers::pi / 2);
    double x = 0, y = 0;
    if (style.align_x == AlignX::kCentre) x = -extents.x_advance / 2;
    if (style.align_x == AlignX::kRight) x = -extents.x_advance;
    if (style.align_y == AlignY::kMiddle) y = kMiddleOfLine * style.size;
    if (style.align_y == AlignY::kTop) y = kTopOfLine * style.size;
    if (style.halo > 0) {
      cairo_move_to(cairo_, x, y);
      cairo_text_path(cairo_, utf8.c_str());
      Ink(kWhite);
      cairo_set_line_width(cairo_, 2 * style.halo);
      cairo_stroke(cairo_);
    }
    cairo_move_to(cairo_, x, y);
    Ink(style.colour);
    cairo_show_text(cairo_, utf8.c_str());
    cairo_restore(cairo_);
  }

  void Paste(const cv::Mat& bgr, const Box& box) override {
    const int stride = cairo_format_stride_for_width(CAIRO_FORMAT_RGB24, bgr.cols);
    std::vector<unsigned char> pixels(static_cast<std::size_t>(stride) * bgr.rows);
    for (int y = 0; y < bgr.rows; ++y) {
      for (int x = 0; x < bgr.cols; ++x) {
        const auto& p = bgr.at<cv::Vec3b>(y, x);
        const std::uint32_t rgb = p[2] << 16 | p[1] << 8 | p[0];
        std::memcpy(&pixels[static_cast<std::size_t>(y) * stride + 4 * x], &rgb, sizeof(rgb));
      }
    }
    cairo_surface_t* image = cairo_image_surface_create_for_data(pixels.data(), CAIRO_FORMAT_RGB24,
                                                                 bgr.cols, bgr.rows, stride);
    cairo_save(cairo_);
    cairo_translate(cairo_, box.x, box.y);
    cairo_scale(cairo_, box.width / bgr.cols, box.height / bgr.rows);
    cairo_set_source_surface(cairo_, image, 0, 0);
    cairo_paint(cairo_);
    cairo_restore(cairo_);
    cairo_surface_flush(surface_);
    cairo_surface_destroy(image);
  }

  std::string Bytes() override {
    cairo_surface_finish(surface_);
    if (const auto status = cairo_surface_status(surface_); status != CAIRO_STATUS_SUCCESS)
      throw std::runtime_error(std::string("cannot make the PDF: ") +
                               cairo_status_to_string(status));
    return bytes_;
  }

 private:
  void Ink(Colour c) { cairo_set_source_rgb(cairo_, c.r / 255.0, c.g / 255.0, c.b / 255.0); }
  void Path(std::span<const Point2> points) {
    cairo_new_path(cairo_);
    for (const Point2& p : points) cairo_line_to(cairo_, p.x, p.y);
  }

  std::string bytes_;
  cairo_surface_t* surface_ = nullptr;
  cairo_t* cairo_ = nullptr;
};

}  // namespace

std::unique_ptr<Sheet> MakePdfSheet(const SheetSize& size) {
  return std::make_unique<PdfSheet>(size);
}

}  // namespace regrasp
