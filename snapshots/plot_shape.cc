#include <fmt/format.h>

#include <array>
#include <numbers>
#include <stdexcept>

#include "snapshots/felt_picture.h"
#include "snapshots/plots.h"
#include "snapshots/refused.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr double kHeight = 620;  // of a wide sheet on paper
constexpr double kNarrowHeight = 1230, kNarrowGap = 10;
constexpr Colour kUnfelt{226, 226, 226};
constexpr double kTouchRadius = 2.2;

/// Opposite, so that every place is seen.
const std::array<Side, 2> kSides = {Side{{-0.85, -1.2, 0.72}, "from −x, −y, +z"},
                                    Side{{0.85, 1.2, -0.72}, "from +x, +y, −z"}};

LegendEntry Swatch(std::string text, Colour colour) {
  return {std::move(text), [colour](Canvas* c, Point2 m) {
            c->FillBox({m.x - 22, m.y - 9, 44, 18}, kLightGrey);
            c->FillBox({m.x - 21, m.y - 8, 42, 16}, colour);
          }};
}

std::vector<LegendGroup> Legends(const FeltPicture& picture, double top) {
  const double scale = picture.scale * 1e3;
  const std::vector<LegendEntry> errors = {
      Swatch(fmt::format("≥ {:g} mm outside", scale), ErrorColour(1)),
      Swatch(fmt::format("{:g} mm outside", scale / 2), ErrorColour(0.5)),
      Swatch("0 mm", ErrorColour(0)),
      Swatch(fmt::format("{:g} mm inside", scale / 2), ErrorColour(-0.5)),
      Swatch(fmt::format("≥ {:g} mm inside", scale), ErrorColour(-1))};
  const double reach = kFeltReach * 180 / std::numbers::pi;
  const std::vector<LegendEntry> marks = {
      {fmt::format("touched, {:.0f} % of it", 100 * picture.judged.touched),
       [](Canvas* c, Point2 m) { c->Disc(m, 1.4 * kTouchRadius, kInk); }},
      Swatch(fmt::format("no touch within {:.0f}°", reach), kUnfelt)};
  std::vector<LegendEntry> figures = FeltFigures(picture);
  if (figures.empty()) figures = {{"nowhere for long", {}}};
  return {{"felt, from the truth", errors, top + 4}, {"", marks}, {"where touched", figures}};
}

/// Where a finger has touched: the middle of each direction that was felt.
void DrawTouches(Canvas* canvas, const ObjectView& view, const FeltSurface& felt) {
  for (int i = 0; i < FeltSurface::kCells; ++i) {
    if (felt.cell(i).count == 0) continue;
    const SurfacePoint point = felt.At(felt.cell(i).direction_sum);
    if (point.normal_O.dot(view.ToViewer()) > 0)
      canvas->Disc(view.At(point.p_O), kTouchRadius, kInk);
  }
}

}  // namespace

void DrawShape(const PlotInput& input, const std::string& path) {
  const auto frames = Newest(input.frames, 0, path).last(1);
  if (!input.felt || input.felt->touched_cells() == 0)
    throw PictureRefused(path, "nothing to draw: no finger has felt the object");
  const FeltPicture picture = JudgeFelt(*input.felt, input.object);

  Canvas canvas(Lower(SizeOf(input.options, kNarrowHeight), kHeight), path);
  const double top = DrawTitle(
      &canvas, input.options.title.empty() ? "The object's surface as felt" : input.options.title,
      Facts(frames, input.hand, input.options));
  const std::vector<LegendGroup> legends = Legends(picture, top);
  const Layout layout(canvas, legends, kNarrowGap);
  layout.DrawLegends(&canvas, legends);

  const ObjectMesh mesh = MeshOf(input.object);
  const auto lines = ShapeLines(mesh);
  const std::array<Box, 2> boxes = TwoBoxes(canvas, layout, top, 20);
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const Box& box = boxes[i];
    const double room = std::min(box.width - 30, box.height - 70);
    const ObjectView view = MakeView(kSides[i].to_viewer, Vector3d::UnitZ(),
                                     box.tl() + Point2(box.width / 2, box.height / 2),
                                     room / (2e3 * input.object.bounding_radius));
    canvas.Clip(box);
    FillObject(&canvas, view, mesh, kUnfelt);
    DrawFelt(&canvas, view, picture);
    DrawObject(&canvas, view, mesh, lines, true);
    DrawTouches(&canvas, view, *input.felt);
    DrawDirections(&canvas, view, box.tl() + Point2(66, 74));
    DrawScaleBar(&canvas, view, {box.x + 20, box.br().y - 24}, 0.3 * box.width);
    canvas.Text({box.br().x - 14, box.y + 20}, kSides[i].name,
                {.size = 18, .colour = kGrey, .align_x = AlignX::kRight, .halo = 2});
    canvas.Unclip();
    DrawBorder(&canvas, box);
  }
  canvas.Save();
}

}  // namespace regrasp
