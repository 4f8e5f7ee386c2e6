#pragma once

/// A sheet of paper: anti-aliased strokes, fills and true text. Internal to snapshots/; the only
/// header here that shows OpenCV.
///
/// Coordinates are logical: x right, y down, 1 logical unit = 1 px of a 1600 x 1000 picture. A
/// picture of another size scales everything, text included, by min(width / 1600, height / 1000).
/// Drawing happens at twice the resolution and is averaged down at the end.

#include <opencv2/core.hpp>
#include <opencv2/freetype.hpp>
#include <span>
#include <string>
#include <vector>

#include "snapshots/palette.h"

namespace regrasp {

using Point2 = cv::Point2d;
using Box = cv::Rect2d;

struct Pen {
  Colour colour = kInk;
  double width = 1.5;
  std::vector<double> dash = {};  ///< lengths of stroke and gap in turn; empty = solid
};

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

class Canvas {
 public:
  static constexpr int kOversampling = 2;

  /// White. Throws std::runtime_error with `path` for a bad size, suffix or a missing font.
  Canvas(int width_px, int height_px, std::string path);

  double width() const { return width_px_ / unit_; }
  double height() const { return height_px_ / unit_; }
  /// Pixels of the finished picture per logical unit.
  double unit() const { return unit_; }

  /// Everything until Unclip() stays inside `box`.
  void Clip(const Box& box);
  void Unclip();

  void Line(Point2 a, Point2 b, const Pen& pen);
  void Polyline(std::span<const Point2> points, const Pen& pen);
  void Polygon(std::span<const Point2> corners, Colour fill);
  void FillBox(const Box& box, Colour fill);
  void Disc(Point2 centre, double radius, Colour fill);
  void Circle(Point2 centre, double radius, const Pen& pen);
  /// `radius`: of the circle that has about the mark's area. Open marks are filled with `inside`.
  void Mark(Marker marker, Point2 centre, double radius, Colour colour, Colour inside);
  void Mark(Marker marker, Point2 centre, double radius, Colour colour) {
    Mark(marker, centre, radius, colour, colour);
  }
  /// From tail to head (the tip). Heads shrink with short arrows.
  void Arrow(Point2 tail, Point2 head, const Pen& pen, double halo = 0);
  void Text(Point2 at, const std::string& utf8, const TextStyle& style);
  double TextWidth(const std::string& utf8, double size, bool bold = false);
  /// Pastes an 8-bit BGR picture that has been made for this box: PixelsOf(box).
  void Paste(const cv::Mat& bgr, const Box& box);
  cv::Size PixelsOf(const Box& box) const;
  /// Pixels of the drawing surface per logical unit.
  double scale() const { return scale_; }

  /// The picture at its final size, 8-bit BGR.
  cv::Mat Finish() const;
  /// Writes the picture. Throws std::runtime_error naming path and cause.
  void Save() const;

 private:
  cv::Point Fixed(Point2 p) const;
  int Thickness(double width) const;
  void Stroke(std::span<const Point2> points, const Pen& pen);

  std::string path_;
  int width_px_, height_px_;
  double unit_, scale_;
  cv::Mat image_, target_;
  cv::Point origin_{0, 0};
  cv::Ptr<cv::freetype::FreeType2> regular_, bold_;
};

}  // namespace regrasp
