#pragma once

/// What pictures are drawn with: strokes, fills, marks and true text, on pixels, PDF or SVG
/// (sheet.h). Internal to snapshots/; with sheet.h the only header here that shows OpenCV.
///
/// Coordinates are logical: x right, y down, 1 logical unit = 1 px of a 1600 x 1000 picture. A
/// picture of another size scales everything, text included, by min(width / logical width,
/// height / 1000).

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "snapshots/palette.h"
#include "snapshots/sheet.h"
#include "snapshots/snapshots.h"

namespace regrasp {

struct Pen {
  Colour colour = kInk;
  double width = 1.5;
  std::vector<double> dash = {};  ///< lengths of stroke and gap in turn; empty = solid
};

struct CanvasSize {
  int width_px = 1600, height_px = 1000;
  double width_mm = 180;        ///< as printed: of a PDF or SVG, and the resolution a PNG names
  double logical_width = 1600;  ///< of the sheet; less makes everything on it larger
  bool with_title = true;
  bool narrow = false;  ///< smaller text for a layout with its legends below
};
/// The size that `options` ask for. On paper the text is at least `font_pt` high: where the printed
/// width leaves no room for legends beside the axes, a picture that has a narrow layout, of
/// `narrow_height` logical units, gets that; one that has none (0) shrinks with its text.
CanvasSize SizeOf(const PlotOptions& options, double narrow_height = 0);
/// A sheet on paper that is wide, but less than a screen, becomes no taller than `height` logical
/// units; others stay.
CanvasSize Lower(CanvasSize size, double height);
/// Whether a picture that has a narrow layout gets it.
bool Narrow(const PlotOptions& options);

class Canvas {
 public:
  /// White. Throws std::runtime_error with `path` for a bad size, suffix or a missing font.
  Canvas(const CanvasSize& size, std::string path);
  /// In memory only: Bytes() are the pixels. Throws the same, with "picture" for the path.
  explicit Canvas(const CanvasSize& size);

  double width() const { return size_.width_px / size_.unit; }
  double height() const { return size_.height_px / size_.unit; }
  /// Pixels of the finished picture per logical unit.
  double unit() const { return size_.unit; }

  const std::string& path() const { return path_; }
  bool with_title() const { return with_title_; }
  /// Legends go below the axes.
  bool narrow() const { return narrow_; }

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
  /// "S_{L}" sets the L as a subscript.
  void Text(Point2 at, const std::string& utf8, const TextStyle& style);
  double TextWidth(const std::string& utf8, double size, bool bold = false) const;
  /// Pastes an 8-bit BGR picture that has been made for this box: PixelsOf(box).
  void Paste(const cv::Mat& bgr, const Box& box);
  cv::Size PixelsOf(const Box& box) const;
  /// Pixels of the drawing surface per logical unit.
  double scale() const { return size_.unit * kOversampling; }

  /// The size at which text of `size` is set: less on a narrow sheet.
  double SetSize(double size) const;

  /// The finished file, byte by byte. Only once, as Save().
  std::string Bytes() { return sheet_->Bytes(); }
  /// Writes the picture. Throws std::runtime_error naming path and cause. Only once.
  void Save();

 private:
  /// A piece of a text in one size.
  struct Piece {
    std::string text;
    bool subscript = false;
  };
  static std::vector<Piece> Pieces(const std::string& utf8);
  double PieceWidth(const Piece& piece, double size, bool bold) const;

  Canvas(const CanvasSize& size, const SheetSize& sheet_size, std::string path);

  std::string path_;
  bool with_title_, narrow_;
  SheetSize size_;
  Fonts fonts_;
  std::unique_ptr<Sheet> sheet_;
};

}  // namespace regrasp
