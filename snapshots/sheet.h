#pragma once

/// What a Canvas draws on: pixels, PDF or SVG. Internal to snapshots/. Coordinates and lengths are
/// logical units (canvas.h); a sheet scales them. Strokes are solid: the canvas makes dashes.

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/freetype.hpp>
#include <span>
#include <string>

#include "snapshots/palette.h"

namespace regrasp {

using Point2 = cv::Point2d;
using Box = cv::Rect2d;

enum class AlignX { kLeft, kCentre, kRight };
enum class AlignY { kTop, kMiddle, kBaseline };

struct TextStyle {
  double size = 19;  ///< em height
  Colour colour = kInk;
  AlignX align_x = AlignX::kLeft;
  AlignY align_y = AlignY::kMiddle;
  bool bold = false;
  bool upwards =
      false;        ///< turned by 90 degrees, reading from bottom to top; alignment is along it
  double halo = 0;  ///< width of a white rim that keeps text readable over drawings
};

/// Height of the middle of a line, and of its top, above its baseline, in em (DejaVu: capitals are
/// 0.73 em high).
inline constexpr double kMiddleOfLine = 0.355, kTopOfLine = 0.76;

class Sheet {
 public:
  virtual ~Sheet() = default;
  /// Everything until Unclip() stays inside `box`.
  virtual void Clip(const Box& box) = 0;
  virtual void Unclip() = 0;
  virtual void Stroke(std::span<const Point2> points, Colour colour, double width) = 0;
  virtual void Polygon(std::span<const Point2> corners, Colour fill) = 0;
  virtual void FillBox(const Box& box, Colour fill) = 0;
  virtual void Disc(Point2 centre, double radius, Colour fill) = 0;
  virtual void Circle(Point2 centre, double radius, Colour colour, double width) = 0;
  virtual void Text(Point2 at, const std::string& utf8, const TextStyle& style) = 0;
  virtual void Paste(const cv::Mat& bgr, const Box& box) = 0;
  /// The finished file, byte by byte. Throws std::runtime_error naming the cause.
  virtual std::string Bytes() = 0;
};

/// Pixels of a raster sheet are drawn at this multiple.
inline constexpr int kOversampling = 2;

/// Instead of a suffix: the bytes of a sheet are its pixels, blue, green, red.
inline constexpr const char* kPixels = "pixels";

/// What a sheet is made for.
struct SheetSize {
  int width_px = 1600, height_px = 1000;
  double unit = 1;        ///< px per logical unit
  double width_mm = 180;  ///< as printed
  std::string suffix;     ///< ".png", ".jpg", ".jpeg", ".pdf" or ".svg"; kPixels: no file
};

/// DejaVu Sans. Throws std::runtime_error naming `picture` when the files are not found.
struct Fonts {
  cv::Ptr<cv::freetype::FreeType2> regular, bold;
  explicit Fonts(const std::string& picture);
};

/// Pixels; drawn at twice the resolution and averaged down at the end.
std::unique_ptr<Sheet> MakeRasterSheet(const SheetSize& size, const Fonts& fonts);
/// Fonts are embedded; text stays text.
std::unique_ptr<Sheet> MakePdfSheet(const SheetSize& size);
/// Text as <text> in DejaVu Sans.
std::unique_ptr<Sheet> MakeSvgSheet(const SheetSize& size);

}  // namespace regrasp
