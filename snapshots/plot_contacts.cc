#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/felt_picture.h"
#include "snapshots/measures.h"
#include "snapshots/object_view.h"
#include "snapshots/plots.h"
#include "snapshots/refused.h"
#include "snapshots/sphere_fit.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr double kMm = 1e3;
constexpr std::size_t kMostPointsDrawn = 5000;
constexpr double kHeight = 920, kNarrowHeight = 1080;  // of the sheet

struct Contact {
  int finger = 0;
  Vector3d p_OC;  ///< [m]
};

struct Cloud {
  std::vector<Contact> points;        ///< all fingers, in order of time
  std::vector<Vector3d> first, last;  ///< of each finger [m]; meaningless without a count
  std::vector<std::size_t> count;     ///< of each finger
  std::size_t stride = 1;             ///< every stride-th point is drawn
};

Cloud Collect(std::span<const Frame> frames, const HandModel& hand) {
  Cloud cloud;
  const auto n = static_cast<std::size_t>(hand.num_fingers());
  cloud.first.resize(n);
  cloud.last.resize(n);
  cloud.count.resize(n, 0);
  for (const Frame& frame : frames) {
    if (!Holds(frame)) continue;
    for (std::size_t f = 0; f < std::min(n, frame.fingers.size()); ++f) {
      if (!frame.fingers[f].in_contact) continue;
      const Vector3d p_OC =
          frame.q_WO_sensed.conjugate() * (frame.fingers[f].p_WC - frame.p_WO_sensed);
      if (!p_OC.allFinite()) continue;
      if (cloud.count[f]++ == 0) cloud.first[f] = p_OC;
      cloud.last[f] = p_OC;
      cloud.points.push_back({static_cast<int>(f), p_OC});
    }
  }
  cloud.stride = 1 + cloud.points.size() / kMostPointsDrawn;
  return cloud;
}

void DrawCloud(Canvas* canvas, const ObjectView& view, const Cloud& cloud, const ObjectMesh& mesh,
               std::span<const SurfaceLine> lines, const std::optional<SphereFit>& fit, double size,
               const FeltPicture* felt = nullptr) {
  // Far half first: far lines, far points, near lines, near points. The object's centre separates
  // them.
  const Vector3d toward = view.ToViewer();
  for (const bool front : {false, true}) {
    if (front && felt != nullptr) DrawFelt(canvas, view, *felt);
    DrawObject(canvas, view, mesh, lines, front);
    for (std::size_t i = 0; i < cloud.points.size(); i += cloud.stride) {
      const Contact& c = cloud.points[i];
      if ((c.p_OC.dot(toward) > 0) != front) continue;
      const FingerLook look = LookOfFinger(c.finger);
      canvas->Disc(view.At(c.p_OC), size, front ? look.colour : Tint(look.colour, 0.62));
    }
  }
  if (fit)
    canvas->Circle(view.At(fit->centre), fit->radius * kMm * view.per_mm, {kInk, 1.8, {9, 6}});
  for (std::size_t f = 0; f < cloud.count.size(); ++f) {
    if (cloud.count[f] == 0) continue;
    const FingerLook look = LookOfFinger(static_cast<int>(f));
    const auto tone = [&](const Vector3d& p) {
      return p.dot(toward) > 0 ? Shade(look.colour, 0.35) : Tint(look.colour, 0.35);
    };
    canvas->Mark(look.marker, view.At(cloud.first[f]), 2.6 * size, tone(cloud.first[f]), kWhite);
    canvas->Mark(look.marker, view.At(cloud.last[f]), 2.6 * size, tone(cloud.last[f]),
                 cloud.last[f].dot(toward) > 0 ? look.colour : Tint(look.colour, 0.62));
  }
}

std::vector<LegendEntry> FitFacts(const std::optional<SphereFit>& fit, const ObjectModel& object) {
  if (!fit) return {{"the points do not", {}}, {"determine a sphere", {}}};
  std::vector<LegendEntry> facts = {
      {fmt::format("radius  {:.2f} mm", fit->radius * kMm), {}},
      {fmt::format("rms error  {:.2f} mm", fit->rms_error * kMm), {}},
      {fmt::format("centre off by  {:.2f} mm", fit->centre.norm() * kMm), {}}};
  if (object.kind == ObjectModel::Kind::kSphere)
    facts.push_back({fmt::format("true radius  {:.2f} mm", object.radius * kMm), {}});
  return facts;
}

/// What is drawn.
struct Content {
  Cloud cloud;
  std::optional<FeltPicture> felt;
  std::optional<SphereFit> fit;
  bool about_sphere = false;  ///< the surface says more than a sphere, unless it is one
};

std::vector<LegendGroup> Legends(const Content& content, const HandModel& hand,
                                 const ObjectModel& object, double top) {
  std::vector<LegendEntry> fingers;
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const FingerLook look = LookOfFinger(f);
    fingers.push_back(MarkEntry(fmt::format("{}  {}", FingerName(hand, f), content.cloud.count[f]),
                                look.marker, look.colour));
  }
  const std::vector<LegendEntry> marks = {
      {"first contact", [](Canvas* c, Point2 m) { c->Mark(Marker::kDisc, m, 6.5, kInk, kWhite); }},
      {"newest contact", [](Canvas* c, Point2 m) { c->Mark(Marker::kDisc, m, 6.5, kInk, kGrey); }},
      {"on the near side", [](Canvas* c, Point2 m) { c->Disc(m, 3.5, kBlue); }},
      {"on the far side", [](Canvas* c, Point2 m) { c->Disc(m, 3.5, Tint(kBlue, 0.62)); }}};
  std::vector<LegendEntry> shapes = {LineEntry("true outline", {Colour{120, 120, 120}, 2})};
  if (content.fit) shapes.push_back(LineEntry("sphere fit", {kInk, 1.8, {9, 6}}));
  std::vector<LegendGroup> groups = {
      {"finger, points", fingers, top + 10}, {"", marks}, {"", shapes}};
  if (content.felt) groups.push_back({"surface as felt", FeltFacts(*content.felt)});
  if (content.about_sphere)
    groups.push_back({"least-squares sphere", FitFacts(content.fit, object)});
  std::vector<LegendEntry> count = {
      {fmt::format("{} points", content.cloud.points.size()), {}, kInk, true}};
  if (content.cloud.stride > 1)
    count.push_back({fmt::format("one in {} drawn", content.cloud.stride), {}, kGrey});
  groups.push_back({"", count});
  return groups;
}

/// Where the perspective view and the two flat ones go.
struct Places {
  Box big;
  std::array<Box, 2> flats;
  Places(const Canvas& canvas, const Layout& layout, double top) {
    if (canvas.narrow()) {
      const double left = 66, gap = 14;
      const double edge = (canvas.width() - 2 * left - 2 * gap) / 2;
      for (int i = 0; i < 2; ++i)
        flats[i] = {left + i * (edge + left + gap), layout.bottom - edge, edge, edge};
      big = {-10, top - 10, canvas.width(), flats[0].y + 10 - top};
      return;
    }
    const double right = layout.left + layout.width, first = top + 24;
    constexpr double kBetween = 92, kBelow = 70;  // for names and values of the axes
    const double edge = std::min((canvas.height() - first - kBetween - kBelow) / 2, 0.32 * right);
    for (int i = 0; i < 2; ++i)
      flats[i] = {right - edge, first + i * (edge + kBetween), edge, edge};
    big = {20, top, flats[0].x - 120, canvas.height() - top - 10};
  }
};

void DrawPerspective(Canvas* canvas, const Box& box, const Content& content, const Axis& axis,
                     const ObjectMesh& mesh, std::span<const SurfaceLine> lines) {
  canvas->Clip({0, box.y, box.br().x + 20, canvas->height() - box.y});
  const ObjectView view = ViewOfCube({-0.85, -1.2, 0.72}, axis.hi, box);
  DrawCube(canvas, view, axis);
  DrawCloud(canvas, view, content.cloud, mesh, lines, content.fit, content.felt ? 1.6 : 3.0,
            content.felt ? &*content.felt : nullptr);
  canvas->Unclip();
}

void DrawFlat(Canvas* canvas, const Box& box, int which, const Content& content, const Axis& axis,
              const ObjectMesh& mesh, std::span<const SurfaceLine> lines) {
  struct Flat {
    Vector3d to_viewer, up;
    const char *x, *y, *title;
  };
  static const std::array<Flat, 2> kFlats = {
      Flat{Vector3d::UnitZ(), Vector3d::UnitY(), "x [mm]", "y [mm]", "seen from +z"},
      Flat{-Vector3d::UnitY(), Vector3d::UnitZ(), "x [mm]", "z [mm]", "seen from −y"}};
  const Flat& flat = kFlats[static_cast<std::size_t>(which)];
  const Panel panel{box, axis, axis};
  DrawGrid(canvas, panel, true);
  canvas->Text({box.x + box.width / 2, box.br().y + 36}, flat.x,
               {.size = 20, .align_x = AlignX::kCentre, .align_y = AlignY::kTop});
  canvas->Text({box.x - (canvas->narrow() ? 52 : 64), box.y + box.height / 2}, flat.y,
               {.size = 20, .align_x = AlignX::kCentre, .upwards = true});
  canvas->Clip(box);
  DrawCloud(canvas,
            MakeView(flat.to_viewer, flat.up, panel.At(0, 0), box.width / (axis.hi - axis.lo)),
            content.cloud, mesh, lines, content.fit, 2.2);
  canvas->Unclip();
  canvas->Text({box.x, box.y - 14}, flat.title, {.size = 17, .colour = kGrey, .halo = 2});
  DrawFrame(canvas, panel);
}

/// Half the edge of the cube that is drawn [mm]: it holds the object and nearly all points.
double HalfOf(std::span<const Vector3d> points, const ObjectModel& object) {
  std::vector<double> sizes;
  for (const Vector3d& p : points) sizes.push_back(p.cwiseAbs().maxCoeff());
  const auto nearly_all =
      sizes.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(sizes.size()) * 0.999);
  std::nth_element(sizes.begin(), nearly_all, sizes.end());
  const double reach = std::max(object.bounding_radius, *nearly_all);
  return std::min(1.16 * reach, 3 * object.bounding_radius) * kMm;
}

}  // namespace

void PlotContacts(std::span<const Frame> history, const HandModel& hand, const ObjectModel& object,
                  const PlotOptions& options, const std::string& path, const FeltSurface* felt) {
  const auto frames = Newest(history, options.last_s, path);
  Content content;
  content.cloud = Collect(frames, hand);
  if (content.cloud.points.empty())
    throw PictureRefused(path, "nothing to draw: no finger held the object in these frames");
  std::vector<Vector3d> points;
  for (const Contact& contact : content.cloud.points) points.push_back(contact.p_OC);
  if (felt != nullptr && felt->touched_cells() > 0) content.felt = JudgeFelt(*felt, object);
  content.about_sphere = object.kind == ObjectModel::Kind::kSphere || !content.felt;
  if (content.about_sphere) content.fit = FitSphere(points);

  Canvas canvas(Lower(SizeOf(options, kNarrowHeight), kHeight), path);
  const ObjectMesh mesh = MeshOf(object);
  const auto lines = ShapeLines(mesh);
  const double top = DrawTitle(
      &canvas,
      options.title.empty() ? "Contact points in the object's frame, as sensed" : options.title,
      Facts(frames, hand, object.name, options.changed));
  const std::vector<LegendGroup> legends = Legends(content, hand, object, top);
  const Layout layout(canvas, legends);
  layout.DrawLegends(&canvas, legends);
  const Places places(canvas, layout, top);
  const double half = HalfOf(points, object);
  const Axis axis = NiceAxis(-half, half, 5, false, ""),
             coarse = NiceAxis(-half, half, 3, false, "");
  DrawPerspective(&canvas, places.big, content, places.big.width < 450 ? coarse : axis, mesh,
                  lines);
  const Axis& flat = canvas.narrow() ? coarse : axis;
  for (int i = 0; i < 2; ++i)
    DrawFlat(&canvas, places.flats[static_cast<std::size_t>(i)], i, content, flat, mesh, lines);
  canvas.Save();
}

void DrawContacts(const PlotInput& input, const std::string& path) {
  PlotContacts(input.frames, input.hand, input.object, input.options, path, input.felt.get());
}

}  // namespace regrasp
