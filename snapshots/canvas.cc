#include "snapshots/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <stdexcept>

#include "core/files/lower_suffix.h"
#include "core/protocol/plot_table.h"
#include "snapshots/refused.h"

namespace regrasp {
namespace {

constexpr double kLogicalWidth = 1600;
constexpr double kSmallestText = 15;      // of all pictures, logical
constexpr double kNarrowest = 1000;       // logical: curves and legends side by side need so much
constexpr double kNarrowestColumn = 400;  // logical: curves with their legends below
constexpr double kNarrowText = 0.8;       // of the size in a wide picture, but kSmallestText
constexpr double kSubscript = 0.7, kSubscriptDrop = 0.2;  // of the text's size

std::string CheckedSuffix(const std::string& path) {
  std::string suffix = LowerSuffix(path);
  if (std::ranges::find(kPlotSuffixes, suffix) == kPlotSuffixes.end())
    throw std::runtime_error(fmt::format("{}: unsupported suffix '{}' (allowed: {})", path, suffix,
                                         fmt::join(kPlotSuffixes, ", ")));
  return suffix;
}

/// Checked: what a canvas of this size is drawn on.
SheetSize SizeOf(const CanvasSize& size, const std::string& suffix, const std::string& path) {
  CheckPictureSize(path, size.width_px, size.height_px);
  const double unit = size.logical_width < kLogicalWidth
                          ? size.width_px / size.logical_width
                          : std::min(size.width_px / kLogicalWidth, size.height_px / 1000.0);
  return {size.width_px, size.height_px, unit, size.width_mm, suffix};
}

std::unique_ptr<Sheet> MakeSheet(const SheetSize& size, const Fonts& fonts) {
  if (size.suffix == ".pdf") return MakePdfSheet(size);
  if (size.suffix == ".svg") return MakeSvgSheet(size);
  return MakeRasterSheet(size, fonts);
}

/// Of a sheet on which the smallest text is `font_pt` high when printed, logical.
double WantedWidth(const PlotOptions& options) {
  return options.width_mm * 72 / 25.4 * kSmallestText / options.font_pt;
}

}  // namespace

bool Narrow(const PlotOptions& options) {
  return options.width_mm > 0 && WantedWidth(options) < kNarrowest;
}

CanvasSize SizeOf(const PlotOptions& options, double narrow_height) {
  CanvasSize size{options.width, options.height};
  size.with_title = options.with_title;
  if (options.width_mm <= 0) return size;
  size.width_mm = options.width_mm;
  if (options.dpi > 0) {
    size.width_px = static_cast<int>(std::lround(options.width_mm / 25.4 * options.dpi));
    size.height_px = options.height * size.width_px / options.width;
  }
  size.narrow = Narrow(options) && narrow_height > 0;
  size.logical_width =
      std::clamp(WantedWidth(options), size.narrow ? kNarrowestColumn : kNarrowest, kLogicalWidth);
  // As much height as a wide picture has: the print becomes taller instead.
  const double grown = size.narrow ? narrow_height * size.width_px / size.logical_width
                                   : size.height_px * kLogicalWidth / size.logical_width;
  size.height_px = static_cast<int>(std::lround(grown));
  return size;
}

CanvasSize Lower(CanvasSize size, double height) {
  if (!size.narrow && size.logical_width < kLogicalWidth)
    size.height_px = std::min(
        size.height_px, static_cast<int>(std::lround(height * size.width_px / size.logical_width)));
  return size;
}

Canvas::Canvas(const CanvasSize& size, std::string path)
    : Canvas(size, SizeOf(size, CheckedSuffix(path), path), path) {}

Canvas::Canvas(const CanvasSize& size)
    : Canvas(size, SizeOf(size, kPixels, "picture"), "picture") {}

Canvas::Canvas(const CanvasSize& size, const SheetSize& sheet_size, std::string path)
    : path_(std::move(path)),
      with_title_(size.with_title),
      narrow_(size.narrow),
      size_(sheet_size),
      fonts_(path_),
      sheet_(MakeSheet(size_, fonts_)) {}

void Canvas::Clip(const Box& box) { sheet_->Clip(box); }
void Canvas::Unclip() { sheet_->Unclip(); }
void Canvas::Polygon(std::span<const Point2> corners, Colour fill) {
  sheet_->Polygon(corners, fill);
}
void Canvas::FillBox(const Box& box, Colour fill) { sheet_->FillBox(box, fill); }
void Canvas::Disc(Point2 centre, double radius, Colour fill) { sheet_->Disc(centre, radius, fill); }
void Canvas::Paste(const cv::Mat& bgr, const Box& box) { sheet_->Paste(bgr, box); }
std::vector<Canvas::Piece> Canvas::Pieces(const std::string& utf8) {
  std::vector<Piece> pieces;
  for (std::size_t at = 0; at < utf8.size();) {
    const std::size_t open = std::min(utf8.find("_{", at), utf8.size());
    if (open > at) pieces.push_back({utf8.substr(at, open - at)});
    if (open == utf8.size()) break;
    const std::size_t close = std::min(utf8.find('}', open), utf8.size());
    pieces.push_back({utf8.substr(open + 2, close - open - 2), true});
    at = close + 1;
  }
  return pieces;
}

double Canvas::SetSize(double size) const {
  return narrow_ ? std::max(kSmallestText, kNarrowText * size) : size;
}

double Canvas::PieceWidth(const Piece& piece, double size, bool bold) const {
  int baseline = 0;
  const double own = piece.subscript ? kSubscript * size : size;
  const int em = std::max(4, static_cast<int>(std::lround(own * scale())));
  return (bold ? fonts_.bold : fonts_.regular)->getTextSize(piece.text, em, -1, &baseline).width /
         scale();
}

void Canvas::Text(Point2 at, const std::string& utf8, const TextStyle& style) {
  TextStyle set = style;
  set.size = SetSize(style.size);
  const std::vector<Piece> pieces = Pieces(utf8);
  if (pieces.empty()) return;
  if (pieces.size() == 1 && !pieces[0].subscript) return sheet_->Text(at, utf8, set);
  const double share = style.align_x == AlignX::kLeft     ? 0
                       : style.align_x == AlignX::kCentre ? 0.5
                                                          : 1;
  const Point2 along = style.upwards ? Point2(0, -1) : Point2(1, 0);
  const Point2 down = style.upwards ? Point2(1, 0) : Point2(0, 1);
  // All pieces stand on one baseline.
  Point2 pen = at - along * (share * TextWidth(utf8, style.size, style.bold));
  if (style.align_y == AlignY::kMiddle) pen += down * (kMiddleOfLine * set.size);
  if (style.align_y == AlignY::kTop) pen += down * (kTopOfLine * set.size);
  for (const Piece& piece : pieces) {
    TextStyle own = set;
    own.align_x = AlignX::kLeft;
    own.align_y = AlignY::kBaseline;
    own.size = piece.subscript ? kSubscript * set.size : set.size;
    sheet_->Text(pen + down * (piece.subscript ? kSubscriptDrop * set.size : 0), piece.text, own);
    pen += along * PieceWidth(piece, set.size, style.bold);
  }
}

void Canvas::Polyline(std::span<const Point2> points, const Pen& pen) {
  if (points.empty()) return;
  if (pen.dash.empty()) return sheet_->Stroke(points, pen.colour, pen.width);
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
        sheet_->Stroke(stroke, pen.colour, pen.width);
      }
      stroke = {from};
      on = !on;
      k = (k + 1) % pen.dash.size();
      left = pen.dash[k];
    }
    left -= length;
    if (on) stroke.push_back(points[i]);
  }
  if (on && stroke.size() > 1) sheet_->Stroke(stroke, pen.colour, pen.width);
}

void Canvas::Line(Point2 a, Point2 b, const Pen& pen) {
  const std::array<Point2, 2> ends = {a, b};
  Polyline(ends, pen);
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
  sheet_->Circle(centre, radius, pen.colour, pen.width);
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
    case Marker::kRing:
      Disc(centre, radius, kWhite);
      Circle(centre, radius, {colour, std::max(1.2, radius * 0.45)});
      break;
    case Marker::kSquare:
      shape(ring(4, 45, 1.25));
      break;
    case Marker::kDiamond:
      shape(ring(4, 0, 1.35));
      break;
    case Marker::kRight:
      shape(ring(3, 0, 1.35));
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

double Canvas::TextWidth(const std::string& utf8, double size, bool bold) const {
  double width = 0;
  for (const Piece& piece : Pieces(utf8)) width += PieceWidth(piece, SetSize(size), bold);
  return width;
}

cv::Size Canvas::PixelsOf(const Box& box) const {
  return {static_cast<int>(std::lround(box.width * scale())),
          static_cast<int>(std::lround(box.height * scale()))};
}

void Canvas::Save() {
  std::string bytes;
  try {
    bytes = sheet_->Bytes();
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: {}", path_, e.what()));
  }
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
