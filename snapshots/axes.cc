#include "snapshots/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr double kTickSize = 19;     // of the text
constexpr double kLineHeight = 1.1;  // of its size

}  // namespace

std::vector<double> Axis::Ticks() const {
  std::vector<double> ticks;
  const double slack = 1e-9 * (hi - lo);
  for (double k = std::ceil((lo - slack) / step); k * step <= hi + slack; ++k)
    ticks.push_back(k * step);
  return ticks;
}

std::string Axis::TickText(double value) const {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  if (std::abs(value) < 1e-9 * step) value = 0;
  const std::string text = fmt::format("{:.{}f}", std::abs(value), decimals);
  return value < 0 ? "\u2212" + text : text;
}

Axis NiceAxis(double lo, double hi, int ticks, bool round_out, std::string label) {
  if (!std::isfinite(lo) || !std::isfinite(hi)) lo = 0, hi = 1;
  if (hi - lo < 1e-9 * std::max(1.0, std::abs(lo))) lo -= 0.5, hi += 0.5;
  const double raw = (hi - lo) / ticks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / power;
  const double step = power * (ratio < 1.414 ? 1 : ratio < 3.162 ? 2 : ratio < 7.071 ? 5 : 10);
  if (round_out) {
    lo = std::floor(lo / step + 1e-9) * step;
    hi = std::ceil(hi / step - 1e-9) * step;
  }
  return {lo, hi, step, std::move(label)};
}

void Range::Add(double value) {
  if (!std::isfinite(value)) return;
  lo = std::min(lo, value);
  hi = std::max(hi, value);
}

void Range::Add(std::span<const double> values) {
  for (double value : values) Add(value);
}

Range Range::Padded(double below, double above) const {
  if (empty()) return *this;
  return {lo - below * (hi - lo), hi + above * (hi - lo)};
}

void DrawGrid(Canvas* canvas, const Panel& panel, bool x_values) {
  const Box& a = panel.area;
  const Pen line{kGridGrey, 1};
  const double below = a.y + a.height;
  for (double v : panel.x.Ticks()) {
    const double x = panel.At(v, 0).x;
    canvas->Line({x, a.y}, {x, below}, line);
    if (!x_values) continue;
    canvas->Line({x, below}, {x, below + 6}, {kInk, 1.5});
    canvas->Text({x, below + 12}, panel.x.TickText(v),
                 {.size = kTickSize, .align_x = AlignX::kCentre, .align_y = AlignY::kTop});
  }
  const double spacing = a.height * panel.y.step / (panel.y.hi - panel.y.lo);
  const long every = std::lround(std::ceil(kLineHeight * canvas->SetSize(kTickSize) / spacing));
  for (double v : panel.y.Ticks()) {
    const double y = panel.At(0, v).y;
    canvas->Line({a.x, y}, {a.x + a.width, y}, line);
    canvas->Line({a.x - 6, y}, {a.x, y}, {kInk, 1.5});
    if (std::lround(v / panel.y.step) % every == 0)  // where there is no room for all
      canvas->Text({a.x - 12, y}, panel.y.TickText(v),
                   {.size = kTickSize, .align_x = AlignX::kRight});
  }
  if (x_values)
    canvas->Text({a.x + a.width / 2, below + (canvas->narrow() ? 34 : 44)}, panel.x.label,
                 {.size = 21, .align_x = AlignX::kCentre, .align_y = AlignY::kTop});
  const bool fits =
      panel.y.short_label.empty() || canvas->TextWidth(panel.y.label, 21) < a.height + 10;
  canvas->Text({a.x - (canvas->narrow() ? 66 : 84), a.y + a.height / 2},
               fits ? panel.y.label : panel.y.short_label,
               {.size = 21, .align_x = AlignX::kCentre, .upwards = true});
}

void DrawFrame(Canvas* canvas, const Panel& panel) {
  const Point2 a = panel.area.tl(), b = panel.area.br();
  const std::vector<Point2> corners = {a, {b.x, a.y}, b, {a.x, b.y}, a};
  canvas->Polyline(corners, {kInk, 1.2});
}

void DrawCurve(Canvas* canvas, const Panel& panel, std::span<const double> xs,
               std::span<const double> ys, const Pen& pen) {
  canvas->Clip(panel.area);
  std::vector<Point2> run;
  std::vector<Point2> column;  // points that fall into one pixel column
  const auto flush = [&] {
    if (column.size() > 4) {
      auto [high, low] = std::minmax_element(column.begin(), column.end(),
                                             [](Point2 a, Point2 b) { return a.y < b.y; });
      if (low < high) std::swap(low, high);
      column = {column.front(), *high, *low, column.back()};
    }
    run.insert(run.end(), column.begin(), column.end());
    column.clear();
  };
  const auto finish = [&] {
    flush();
    canvas->Polyline(run, pen);
    run.clear();
  };
  for (std::size_t i = 0; i < xs.size(); ++i) {
    if (!std::isfinite(ys[i])) {
      finish();
      continue;
    }
    const Point2 p = panel.At(xs[i], ys[i]);
    if (!column.empty() && std::floor(p.x) != std::floor(column.front().x)) flush();
    column.push_back(p);
  }
  finish();
  canvas->Unclip();
}

LegendEntry LineEntry(std::string text, Pen pen) {
  return {std::move(text), [pen](Canvas* canvas, Point2 middle) {
            canvas->Line(middle - Point2(22, 0), middle + Point2(22, 0), pen);
          }};
}

LegendEntry MarkEntry(std::string text, Marker marker, Colour colour) {
  return {std::move(text),
          [=](Canvas* canvas, Point2 middle) { canvas->Mark(marker, middle, 6.5, colour); }};
}

double DrawLegend(Canvas* canvas, Point2 at, const std::string& heading,
                  std::span<const LegendEntry> entries) {
  double y = at.y;
  if (!heading.empty()) {
    canvas->Text({at.x, y + 10}, heading, {.size = 18, .bold = true});
    y += 30;
  }
  for (const LegendEntry& entry : entries) {
    if (entry.symbol) entry.symbol(canvas, {at.x + 22, y + 10});
    canvas->Text({at.x + (entry.symbol ? 56 : 0), y + 10}, entry.text,
                 {.size = 18, .colour = entry.colour, .bold = entry.bold});
    y += 27;
  }
  return y;
}

namespace {

constexpr double kLine = 22, kGap = 16, kSymbol = 50;  // of legends below the axes

/// Legends in lines that wrap; returns the y below them. `canvas` only measures where it is null.
double FlowLegends(const Canvas& measure, Canvas* canvas, Point2 at, double width,
                   std::span<const LegendGroup> groups) {
  double x = at.x, y = at.y;
  const auto place = [&](double wide) {
    if (x > at.x && x + wide > at.x + width) {
      x = at.x;
      y += kLine;
    }
    const Point2 here(x, y + kLine / 2);
    x += wide + kGap;
    return here;
  };
  for (const LegendGroup& group : groups) {
    if (group.entries.empty()) continue;
    if (x > at.x) y += kLine;
    x = at.x;
    if (!group.heading.empty()) {
      const Point2 here = place(measure.TextWidth(group.heading, 18, true));
      if (canvas) canvas->Text(here, group.heading, {.size = 18, .bold = true});
    }
    for (const LegendEntry& entry : group.entries) {
      const double symbol = entry.symbol ? kSymbol : 0;
      const Point2 here = place(symbol + measure.TextWidth(entry.text, 18, entry.bold));
      if (!canvas) continue;
      if (entry.symbol) entry.symbol(canvas, here + Point2(22, 0));
      canvas->Text(here + Point2(symbol, 0), entry.text,
                   {.size = 18, .colour = entry.colour, .bold = entry.bold});
    }
  }
  return y + kLine;
}

}  // namespace

Layout::Layout(const Canvas& canvas, std::span<const LegendGroup> groups, double axis_room)
    : below(axis_room) {
  left = canvas.narrow() ? 94 : 150;
  width = canvas.width() - left - (canvas.narrow() ? 14 : 290);
  bottom = canvas.height() - 90;
  if (canvas.narrow())
    bottom = canvas.height() - below - 6 -
             FlowLegends(canvas, nullptr, {14, 0}, canvas.width() - 28, groups);
}

void Layout::DrawLegends(Canvas* canvas, std::span<const LegendGroup> groups) const {
  if (canvas->narrow()) {
    FlowLegends(*canvas, canvas, {14, bottom + below}, canvas->width() - 28, groups);
    return;
  }
  double y = 0;
  for (const LegendGroup& group : groups)
    if (!group.entries.empty())
      y = DrawLegend(canvas, {left + width + 28, std::max(y, group.y)}, group.heading,
                     group.entries) +
          10;
}

std::array<Box, 2> TwoBoxes(const Canvas& canvas, const Layout& layout, double top, double under) {
  if (canvas.narrow()) {
    constexpr double kGap = 10, kMargin = 14;
    const double height = (layout.bottom - top - kGap) / 2;
    const double width = canvas.width() - 2 * kMargin;
    return {Box(kMargin, top, width, height), Box(kMargin, top + height + kGap, width, height)};
  }
  constexpr double kGap = 20;
  const double width = (layout.left + layout.width - 2 * kGap) / 2;
  const double height = canvas.height() - top - under;
  return {Box(kGap, top, width, height), Box(2 * kGap + width, top, width, height)};
}

void DrawBorder(Canvas* canvas, const Box& box) {
  const std::vector<Point2> corners = {
      box.tl(), {box.br().x, box.y}, box.br(), {box.x, box.br().y}, box.tl()};
  canvas->Polyline(corners, {kLightGrey, 1});
}

double DrawTitle(Canvas* canvas, const std::string& title, const std::string& facts) {
  const bool narrow = canvas->narrow();
  if (!canvas->with_title()) return narrow ? 14 : 104;
  const double left = narrow ? 14 : 40, room = canvas->width() - 2 * left;
  constexpr double kLeastFacts = 15;  // smaller ones go into another line
  const auto fitted = [&](const std::string& text, double size, bool bold) {
    while (size > 1 && canvas->TextWidth(text, size, bold) > room) size -= 0.5;
    return size;
  };
  double y = narrow ? 24 : 38;
  canvas->Text({left, y}, title, {.size = fitted(title, narrow ? 24 : 28, true), .bold = true});
  y += narrow ? 28 : 36;
  const double size = fitted(facts, 18, false);
  if (size >= kLeastFacts && !narrow) {
    canvas->Text({left, y}, facts, {.size = size, .colour = kGrey});
    return y + 30;
  }
  std::string line, rest = facts;
  const auto put = [&] {
    canvas->Text({left, y}, line, {.size = 16, .colour = kGrey});
    y += narrow ? 19 : 22;
    line.clear();
  };
  constexpr std::string_view kBetween = " · ";
  while (!rest.empty()) {
    const auto end = rest.find(kBetween);
    const std::string fact = rest.substr(0, end);
    rest = end == std::string::npos ? "" : rest.substr(end + kBetween.size());
    const std::string longer = line.empty() ? fact : line + std::string(kBetween) + fact;
    if (!line.empty() && canvas->TextWidth(longer, 16) > room) put();
    line = line.empty() ? fact : line + std::string(kBetween) + fact;
    // A list that is longer than a line goes on in the next one.
    while (canvas->TextWidth(line, 16) > room) {
      std::size_t end_of_line = line.size();
      do end_of_line = line.rfind(", ", end_of_line - 1);
      while (end_of_line != std::string::npos && end_of_line > 0 &&
             canvas->TextWidth(line.substr(0, end_of_line + 1), 16) > room);
      if (end_of_line == std::string::npos || end_of_line == 0) break;
      const std::string more = line.substr(end_of_line + 2);
      line.resize(end_of_line + 1);
      put();
      line = more;
    }
  }
  put();
  return y + (narrow ? 2 : 8);
}

}  // namespace regrasp
