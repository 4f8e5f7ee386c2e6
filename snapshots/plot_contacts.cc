#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/session/shape_judge.h"
#include "core/shape/felt_mesh.h"
#include "core/world/true_surface.h"
#include "snapshots/axes.h"
#include "snapshots/measures.h"
#include "snapshots/outline.h"
#include "snapshots/plots.h"
#include "snapshots/sphere_fit.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr double kMm = 1e3;
constexpr std::size_t kMostPointsDrawn = 5000;
constexpr double kTop = 100, kNarrowHeight = 1080;  // of the sheet

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

/// Orthographic view: right, up and towards the viewer in O; p [m] is drawn in mm.
struct View {
  Matrix3d R_VO;  ///< rows: right, up, to the viewer
  Point2 centre;  ///< of the sheet
  double per_mm;  ///< logical units
  Point2 At(const Vector3d& p_O) const {
    const Vector3d v = R_VO * p_O * kMm;
    return centre + Point2(v.x(), -v.y()) * per_mm;
  }
  Vector3d ToViewer() const { return R_VO.row(2); }
};

View MakeView(const Vector3d& to_viewer, const Vector3d& up, Point2 centre, double per_mm) {
  View view;
  const Vector3d z = to_viewer.normalized(), x = up.cross(z).normalized();
  view.R_VO << x.transpose(), z.cross(x).transpose(), z.transpose();
  view.centre = centre;
  view.per_mm = per_mm;
  return view;
}

void DrawObject(Canvas* canvas, const View& view, const ObjectMesh& mesh,
                std::span<const SurfaceLine> lines, bool front) {
  for (const SurfaceLine& line : lines)
    if (line.FacesViewer(view.ToViewer()) == front)
      canvas->Line(view.At(line.a_O), view.At(line.b_O),
                   {front ? Colour{172, 172, 172} : Colour{222, 222, 222}, front ? 1.2 : 1.0});
  if (!front) return;
  for (const SurfaceLine& line : Silhouette(mesh, view.ToViewer()))
    canvas->Line(view.At(line.a_O), view.At(line.b_O), {Colour{120, 120, 120}, 2});
}

/// The felt surface, and by how much each vertex is off the true one [m].
struct FeltPicture {
  FeltMesh mesh;
  std::vector<double> errors;
  double scale = 0;  ///< error that has the full colour [m]
  ShapeErrors judged;
};

constexpr int kDivisions = 5;
constexpr double kKnown = 0.2;  // farther from what was felt the surface is not drawn [rad]

FeltPicture PictureOf(const FeltSurface& felt, const ObjectModel& object) {
  FeltPicture picture;
  const TrueSurface truth(object);
  picture.mesh = MeshOf(felt, kDivisions);
  std::vector<double> sizes;
  for (const SurfacePoint& point : picture.mesh.vertices) {
    picture.errors.push_back(truth.At(point.p_O).distance);
    if (point.unknown < kKnown) sizes.push_back(std::abs(picture.errors.back()));
  }
  picture.judged = JudgeShape(felt, truth);
  if (sizes.empty()) return picture;
  const auto most = sizes.begin() + static_cast<std::ptrdiff_t>(0.95 * (sizes.size() - 1));
  std::nth_element(sizes.begin(), most, sizes.end());
  constexpr std::array kScales = {0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3};
  const auto scale = std::ranges::find_if(kScales, [&](double s) { return s >= *most; });
  picture.scale = scale == kScales.end() ? kScales.back() : *scale;
  return picture;
}

/// Blue inside the true surface, white on it, orange outside; `share` of the full colour, -1 to 1.
Colour ErrorColour(double share) {
  return Tint(share < 0 ? kBlue : kVermillion, 1 - std::min(1.0, std::abs(share)));
}

void DrawFelt(Canvas* canvas, const View& view, const FeltPicture& picture) {
  for (const Eigen::Vector3i& t : picture.mesh.triangles) {
    std::array<Point2, 3> corners;
    Vector3d normal = Vector3d::Zero();
    double error = 0, unknown = 0;
    for (int k = 0; k < 3; ++k) {
      const SurfacePoint& point = picture.mesh.vertices[t[k]];
      corners[k] = view.At(point.p_O);
      normal += point.normal_O;
      error += picture.errors[t[k]] / 3;
      unknown = std::max(unknown, point.unknown);
    }
    const double facing = normal.normalized().dot(view.ToViewer());
    if (unknown > kKnown || facing <= 0) continue;
    // A little shade, so that the shape is seen.
    const Colour colour = Shade(ErrorColour(error / picture.scale), 0.25 * (1 - facing));
    canvas->Polygon(corners, colour);
    for (int k = 0; k < 3; ++k) canvas->Line(corners[k], corners[(k + 1) % 3], {colour, 1});
  }
}

void DrawCloud(Canvas* canvas, const View& view, const Cloud& cloud, const ObjectMesh& mesh,
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

/// The three far walls of the cube |x|, |y|, |z| <= half, with grid, ticks and names of the axes.
void DrawCube(Canvas* canvas, const View& view, const Axis& axis) {
  const Vector3d toward = view.ToViewer();
  const double half = axis.hi / kMm;
  Vector3d far;  // corner of the cube farthest from the viewer
  for (int k = 0; k < 3; ++k) far[k] = toward[k] > 0 ? -half : half;
  auto ticks =
      axis.Ticks();  // without those at the cube's corners, where the values of two edges meet
  std::erase_if(ticks, [&](double tick) { return std::abs(tick) > 0.94 * axis.hi; });
  for (int wall = 0; wall < 3; ++wall) {
    const int u = (wall + 1) % 3, v = (wall + 2) % 3;
    const auto corner = [&](double cu, double cv) {
      Vector3d p = far;
      p[u] = cu;
      p[v] = cv;
      return view.At(p);
    };
    const std::vector<Point2> wall_corners = {corner(-half, -half), corner(half, -half),
                                              corner(half, half), corner(-half, half)};
    canvas->Polygon(wall_corners, wall == 2 ? Colour{246, 246, 246} : Colour{250, 250, 250});
    for (double tick : ticks) {
      canvas->Line(corner(tick / kMm, -half), corner(tick / kMm, half), {kGridGrey, 1});
      canvas->Line(corner(-half, tick / kMm), corner(half, tick / kMm), {kGridGrey, 1});
    }
  }
  // x and y are written along the near edges of the floor, z along the leftmost upright edge.
  static constexpr const char* kNames[] = {"x [mm]", "y [mm]", "z [mm]"};
  for (int k = 0; k < 3; ++k) {
    Vector3d edge = -far;
    edge[2] = -half;
    if (k == 2) {
      edge = far;
      // Of the two edges between a far and a near wall take the one further left.
      Vector3d other = far;
      edge[0] = -far[0];
      other[1] = -far[1];
      if (view.At(other).x < view.At(edge).x) edge = other;
    }
    Vector3d from = edge, to = edge;
    from[k] = -half;
    to[k] = half;
    const Point2 a = view.At(from), b = view.At(to), middle = (a + b) * 0.5;
    canvas->Line(a, b, {kInk, 1.5});
    // Ticks point away from the cube's centre on the sheet, perpendicular to the edge.
    Point2 out(-(b - a).y, (b - a).x);
    out *= 1.0 / std::max(1e-9, cv::norm(out));
    if (out.dot(middle - view.centre) < 0) out = -out;
    for (double tick : ticks) {
      Vector3d p = edge;
      p[k] = tick / kMm;
      const Point2 at = view.At(p);
      canvas->Line(at, at + out * 7, {kInk, 1.5});
      canvas->Text(at + out * (k == 2 ? 32 : 26), axis.TickText(tick),
                   {.size = 18, .align_x = AlignX::kCentre});
    }
    canvas->Text(middle + out * (k == 2 ? 74 : 78), kNames[k],
                 {.size = 20, .align_x = AlignX::kCentre, .upwards = k == 2});
  }
}

/// Scale of the colours and figures of the felt surface.
std::vector<LegendEntry> FeltFacts(const FeltPicture& picture) {
  const double scale = picture.scale * kMm;
  std::vector<LegendEntry> facts = {
      {fmt::format("−{:.1f} to {:.1f} mm off", scale, scale), [](Canvas* c, Point2 m) {
         constexpr int kSteps = 22;
         for (int i = 0; i < kSteps; ++i)
           c->FillBox({m.x - 22 + 44.0 * i / kSteps, m.y - 8, 44.0 / kSteps + 0.5, 16},
                      ErrorColour(2.0 * i / (kSteps - 1) - 1));
       }}};
  const ShapeErrors& judged = picture.judged;
  facts.push_back({fmt::format("touched  {:.0f} % of it", 100 * judged.touched), {}});
  if (judged.cells > 0) {
    facts.push_back({fmt::format("rms error  {:.2f} mm", judged.rms_m * kMm), {}});
    const double bias = judged.mean_m * kMm;
    facts.push_back({fmt::format("bias  {:.2f} mm", std::abs(bias) < 0.005 ? 0 : bias), {}});
    facts.push_back(
        {fmt::format("normals off by  {:.1f}°", judged.normal_rad * 180 / std::numbers::pi), {}});
  }
  return facts;
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
                                 const ObjectModel& object) {
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
      {"finger, points", fingers, kTop + 10}, {"", marks}, {"", shapes}};
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
    const double edge = (canvas.height() - 110 - 2 * 92) / 2;  // of a square panel
    const double right = layout.left + layout.width;
    for (int i = 0; i < 2; ++i) flats[i] = {right - edge, 106 + i * (edge + 92), edge, edge};
    big = {20, kTop, flats[0].x - 120, canvas.height() - 110};
  }
};

void DrawPerspective(Canvas* canvas, const Box& box, const Content& content, const Axis& axis,
                     const ObjectMesh& mesh, std::span<const SurfaceLine> lines) {
  canvas->Clip({0, box.y, box.br().x + 20, canvas->height() - box.y});
  View view = MakeView({-0.85, -1.2, 0.72}, Vector3d::UnitZ(), {0, 0}, 1);
  Range across, down;  // of the cube's corners, at 1 unit per mm
  for (int i = 0; i < 8; ++i) {
    const Point2 corner =
        view.At(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1) * axis.hi / kMm);
    across.Add(corner.x);
    down.Add(corner.y);
  }
  // Room for tick values and names: 90 on the left and below.
  view.per_mm = std::min((box.width - 100) / (across.hi - across.lo),
                         (box.height - 100) / (down.hi - down.lo));
  view.centre = {box.x + 95 + (box.width - 100) / 2, box.y + 10 + (box.height - 100) / 2};
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
  canvas->Text(canvas->narrow() ? Point2(box.x, box.y - 14) : Point2(box.x + 10, box.y + 18),
               flat.title, {.size = 17, .colour = kGrey, .halo = 2});
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
    throw std::runtime_error(path + ": nothing to draw: no finger held the object in these frames");
  std::vector<Vector3d> points;
  for (const Contact& contact : content.cloud.points) points.push_back(contact.p_OC);
  if (felt != nullptr && felt->touched_cells() > 0) content.felt = PictureOf(*felt, object);
  content.about_sphere = object.kind == ObjectModel::Kind::kSphere || !content.felt;
  if (content.about_sphere) content.fit = FitSphere(points);

  Canvas canvas(SizeOf(options, kNarrowHeight), path);
  const ObjectMesh mesh = MeshOf(object);
  const auto lines = ShapeLines(mesh);
  const double top = DrawTitle(
      &canvas,
      options.title.empty() ? "Contact points in the object's frame, as sensed" : options.title,
      Facts(frames, hand, object.name));
  const std::vector<LegendGroup> legends = Legends(content, hand, object);
  const Layout layout(canvas, legends);
  layout.DrawLegends(&canvas, legends);
  const Places places(canvas, layout, top);
  const double half = HalfOf(points, object);
  const Axis axis = NiceAxis(-half, half, 5, false, "");
  DrawPerspective(&canvas, places.big, content, axis, mesh, lines);
  const Axis flat = canvas.narrow() ? NiceAxis(-half, half, 3, false, "") : axis;
  for (int i = 0; i < 2; ++i)
    DrawFlat(&canvas, places.flats[static_cast<std::size_t>(i)], i, content, flat, mesh, lines);
  canvas.Save();
}

void DrawContacts(const PlotInput& input, const std::string& path) {
  PlotContacts(input.frames, input.hand, input.object, input.options, path, input.felt.get());
}

}  // namespace regrasp
