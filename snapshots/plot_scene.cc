#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/hand/kinematics.h"
#include "snapshots/axes.h"
#include "snapshots/plots.h"
#include "snapshots/renderer.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr Colour kPalm{214, 214, 218}, kObjectLight{244, 236, 212}, kObjectDark{222, 205, 160};
constexpr double kTop = 104;  // of the views on a wide sheet
constexpr double kNarrowHeight = 1050, kNarrowGap = 10;
constexpr double kFilmDetail = 0.75;  // of the bodies; 1.5 x 1.5 samples a pixel instead of 2 x 2
constexpr double kScaleBar = 0.02;    // [m]
constexpr double kOutOfView = 0.15;   // an object this far from every fingertip is left out [m]

/// False once the object has fallen away, or its pose is no number after a fault: the picture is of
/// the hand.
bool ObjectInView(const Frame& frame, const ObjectModel& object) {
  if (!frame.p_WO.allFinite() || !frame.q_WO.coeffs().allFinite()) return false;
  return std::any_of(frame.fingers.begin(), frame.fingers.end(), [&](const FingerFrame& finger) {
    return (finger.true_tip_W - frame.p_WO).norm() < kOutOfView + object.bounding_radius;
  });
}

std::vector<Body> Bodies(const Frame& frame, const HandModel& hand, const ObjectModel& object) {
  KinematicsData kinematics;
  ForwardKinematics(hand, frame.q, &kinematics);
  // A finger's last link has its full colour, the others paler ones towards the palm.
  std::vector<Colour> colours(hand.links.size(), kPalm);
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const auto& joints = hand.fingers[f].joints;
    const Colour colour = LookOfFinger(f).colour;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double to_tip = static_cast<double>(joints.size() - 1 - i);
      colours[hand.joints[joints[i]].child_link] =
          Tint(colour, std::min(0.78, 0.45 + 0.11 * to_tip));
    }
    if (hand.fingers[f].tip_link >= 0) colours[hand.fingers[f].tip_link] = Tint(colour, 0.08);
  }
  std::vector<Body> bodies;
  for (std::size_t l = 0; l < hand.links.size(); ++l)
    for (const Shape& shape : hand.links[l].shapes) {
      Body body;
      body.X_WB = kinematics.X_WL[l];
      if (shape.kind == Shape::Kind::kBox) {
        body.kind = Body::Kind::kBox;
        body.X_WB = kinematics.X_WL[l] * shape.X_LB;
        body.half_extents = shape.half_extents;
      } else {
        body.a_B = shape.a_L;
        body.b_B = shape.b_L;
        body.radius = shape.radius;
      }
      body.colour = body.second_colour = colours[l];
      body.id = static_cast<int>(l);
      bodies.push_back(std::move(body));
    }
  if (!ObjectInView(frame, object)) return bodies;
  Body body;
  body.X_WB.linear() = frame.q_WO.toRotationMatrix();
  body.X_WB.translation() = frame.p_WO;
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
    case ObjectModel::Kind::kCapsule:
      body.radius = object.radius;
      body.b_B =
          Vector3d(0, 0, object.kind == ObjectModel::Kind::kCapsule ? object.half_length : 0);
      body.a_B = -body.b_B;
      break;
    case ObjectModel::Kind::kBox:
      body.kind = Body::Kind::kBox;
      body.half_extents = object.half_extents;
      break;
    case ObjectModel::Kind::kMesh:
      body.kind = Body::Kind::kMesh;
      body.mesh = MeshOf(object);
      break;
  }
  body.colour = kObjectLight;
  body.second_colour = kObjectDark;
  body.id = static_cast<int>(hand.links.size());
  bodies.push_back(std::move(body));
  return bodies;
}

/// 1, 2 or 5 times a power of ten, at most `value`.
double NiceBelow(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double ratio = value / power;
  return power * (ratio >= 5 ? 5 : ratio >= 2 ? 2 : 1);
}

/// `detail`: pixels rendered per pixel of the picture, along either side.
cv::Mat RenderWith(double detail, std::span<const Body> bodies, const Camera& camera,
                   cv::Size size) {
  if (detail == 1) return Render(bodies, camera, size);
  Camera coarse = camera;
  coarse.focal_px *= detail;
  coarse.centre_x_px = (camera.centre_x_px + 0.5) * detail - 0.5;
  coarse.centre_y_px = (camera.centre_y_px + 0.5) * detail - 0.5;
  const cv::Size less(cvRound(size.width * detail), cvRound(size.height * detail));
  cv::Mat picture;
  cv::resize(Render(bodies, coarse, less), picture, size, 0, 0, cv::INTER_LINEAR);
  return picture;
}

/// One of the two pictures: the rendered bodies with everything that is written on them.
class ViewPainter {
 public:
  ViewPainter(Canvas* canvas, const Box& box, std::span<const Body> bodies,
              const Vector3d& to_viewer, const Vector3d& up, double detail)
      : canvas_(canvas), box_(box) {
    const cv::Size size = canvas->PixelsOf(box);
    // Room above for names and directions, below for the scales; a narrow sheet has it at the
    // sides.
    const double unit = canvas->scale(), above = canvas->narrow() ? 40 : 46;
    const double below = canvas->narrow() ? 14 : 74;
    camera_ = FitCamera(bodies, to_viewer, up,
                        size - cv::Size(0, static_cast<int>((above + below) * unit)), 34 * unit);
    camera_.centre_y_px += above * unit;
    const cv::Mat picture = RenderWith(detail, bodies, camera_, size);
    canvas->Paste(picture, box);
    cv::Mat grey;
    cv::extractChannel(picture, grey, 1);
    cv::resize(grey, grey, {}, 1 / kCoarse, 1 / kCoarse, cv::INTER_NEAREST);
    cv::integral(grey != 255, drawn_, CV_32S);
    taken_ = {{box.x, box.y, box.width, 34},        // what is seen
              {box.x, box.y, 150, 120},             // axes
              {box.br().x - 120, box.y, 120, 140},  // gravity
              {box.x, box.br().y - 84, 240, 84}};   // scales
  }

  Point2 At(const Vector3d& p_W) const {
    return box_.tl() + camera_.Project(p_W) * (1 / canvas_->scale());
  }
  double PerMetreAt(const Vector3d& p_W) const { return camera_.ScaleAt(p_W) / canvas_->scale(); }

  /// The force as an arrow that pushes with its head on the contact point.
  void Force(const Vector3d& p_W, const Vector3d& f_W, double metres_per_newton, Colour dot) {
    const Point2 head = At(p_W), tail = At(p_W - f_W * metres_per_newton);
    canvas_->Disc(head, 7, kWhite);
    canvas_->Disc(head, 5.2, dot);
    canvas_->Arrow(tail, head, {kInk, 3.6}, 1.6);
    taken_.push_back(Box(Point2(std::min(head.x, tail.x), std::min(head.y, tail.y)),
                         Point2(std::max(head.x, tail.x) + 1, std::max(head.y, tail.y) + 1)));
  }

  /// A name near `p_W`, away from `from` on the sheet and from what has been written before.
  void Label(const Vector3d& p_W, Point2 from, const std::string& text, Colour colour) {
    const double width = canvas_->TextWidth(text, 20, true), height = 24;
    const Point2 at = At(p_W);
    Point2 away = at - from;
    away *= 1 / std::max(1.0, cv::norm(away));
    Point2 best = at;
    double best_cost = 1e30;
    for (double distance : {40.0, 56.0, 74.0, 96.0, 122.0})
      for (int i = 0; i < 16; ++i) {
        const double a = i * std::numbers::pi / 8;
        const Point2 direction(std::cos(a), std::sin(a));
        const Point2 centre =
            at + Point2(direction.x * (distance + width / 2 - 10), direction.y * distance);
        const Box room(centre.x - width / 2 - 4, centre.y - height / 2 - 2, width + 8, height + 4);
        double cost = 0.8 * distance - 20 * direction.dot(away) + 90 * Covered(room);
        for (const Box& other : taken_) cost += 3 * std::sqrt((room & other).area());
        if ((room & box_).area() < room.area() - 1) cost += 1e4;
        if (cost < best_cost) best_cost = cost, best = centre;
      }
    taken_.push_back({best.x - width / 2 - 4, best.y - height / 2 - 2, width + 8, height + 4});
    canvas_->Line(at, at + (best - at) * std::max(0.0, 1 - 17 / cv::norm(best - at)), {kInk, 1.2});
    canvas_->Text(
        best, text,
        {.size = 20, .colour = colour, .align_x = AlignX::kCentre, .bold = true, .halo = 2.5});
  }

  /// Directions x, y, z of the palm's frame, and gravity, in the corners at the top.
  void Directions(const Vector3d& gravity_W) {
    const Matrix3d& R_CW = camera_.X_CW.linear();
    const auto draw = [&](Point2 origin, const Vector3d& direction_W, double length, const Pen& pen,
                          const std::string& name, Colour colour) {
      const Vector3d d = R_CW * direction_W;
      const Point2 on_sheet(d.x(), d.y());
      if (cv::norm(on_sheet) < 0.42) {  // along the line of sight: a ring with a dot or a cross
        canvas_->Disc(origin, 9, kWhite);
        canvas_->Circle(origin, 9, {pen.colour, 2});
        if (d.z() < 0)
          canvas_->Disc(origin, 3, pen.colour);
        else
          canvas_->Mark(Marker::kCross, origin, 6, pen.colour);
        canvas_->Text(origin + Point2(-22, 16), name, {.size = 18, .colour = colour});
        return;
      }
      const Point2 head = origin + on_sheet * length;
      canvas_->Arrow(origin, head, pen);
      canvas_->Text(head + on_sheet * (16 / cv::norm(on_sheet)), name,
                    {.size = 18, .colour = colour, .align_x = AlignX::kCentre});
    };
    const Point2 triad = box_.tl() + Point2(70, 78);
    std::array<int, 3> order = {0, 1, 2};  // what points at the viewer goes on top
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return std::abs(R_CW(2, a)) < std::abs(R_CW(2, b)); });
    static constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
    for (int k : order) draw(triad, Vector3d::Unit(k), 46, {kGrey, 2.4}, kNames[k], kGrey);
    if (gravity_W.norm() > 1e-6)
      draw({box_.br().x - 70, box_.y + 66}, gravity_W.normalized(), 62, {kInk, 4}, "g", kInk);
  }

  /// Lengths at the depth of the object, in the lower left corner.
  void Scales(const Vector3d& p_WO, double newton, double metres_per_newton) {
    const double per_metre = PerMetreAt(p_WO);
    const Point2 at(box_.x + 24, box_.br().y - 58);
    const Point2 end = at + Point2(kScaleBar * per_metre, 0);
    canvas_->Line(at, end, {kInk, 2.5});
    for (const Point2& p : {at, end})
      canvas_->Line(p - Point2(0, 6), p + Point2(0, 6), {kInk, 2.5});
    canvas_->Text(end + Point2(12, 0), fmt::format("{:.0f} mm", kScaleBar * 1e3),
                  {.size = 18, .halo = 2});
    if (newton <= 0) return;
    const Point2 tail = at + Point2(0, 32),
                 head = tail + Point2(newton * metres_per_newton * per_metre, 0);
    canvas_->Arrow(tail, head, {kInk, 3.6});
    canvas_->Text({std::max(head.x, end.x) + 12, head.y}, fmt::format("{:g} N", newton),
                  {.size = 18, .halo = 2});
  }

 private:
  Canvas* canvas_;
  Box box_;
  /// Part of a box on the sheet that bodies cover, 0 .. 1.
  double Covered(const Box& room) const {
    const double k = canvas_->scale() / kCoarse;
    const auto column = [&](double x) {
      return std::clamp(static_cast<int>((x - box_.x) * k), 0, drawn_.cols - 1);
    };
    const auto row = [&](double y) {
      return std::clamp(static_cast<int>((y - box_.y) * k), 0, drawn_.rows - 1);
    };
    const int x0 = column(room.x), x1 = column(room.br().x), y0 = row(room.y),
              y1 = row(room.br().y);
    const double sum = drawn_(y1, x1) - drawn_(y0, x1) - drawn_(y1, x0) + drawn_(y0, x0);
    return sum / 255 / std::max(1, (x1 - x0) * (y1 - y0));
  }

  static constexpr double kCoarse = 4;  // pixels of the picture per cell of drawn_
  Camera camera_;
  std::vector<Box> taken_;
  cv::Mat_<int> drawn_;  ///< sums over the cells above and to the left that show a body, 255 each
};

/// Forces on the object, for scales and legends.
struct Forces {
  std::vector<double> of_finger;  ///< sum of magnitudes [N]
  double other = 0, largest = 0;  ///< [N]
  Vector3d sum_W = Vector3d::Zero();
  // The largest force is drawn 35 mm long.
  double metres_per_newton() const { return largest > 1e-6 ? 0.035 / largest : 0; }
  double scale() const { return largest > 1e-6 ? NiceBelow(largest) : 0; }  ///< [N]
};

Forces ForcesOf(const Frame& frame, const HandModel& hand) {
  Forces forces;
  forces.of_finger.resize(hand.fingers.size(), 0);
  for (const Frame::Contact& contact : frame.contacts) {
    const double force = contact.force_W.norm();
    forces.largest = std::max(forces.largest, force);
    forces.sum_W += contact.force_W;
    (contact.finger >= 0 && contact.finger < hand.num_fingers()
         ? forces.of_finger[static_cast<std::size_t>(contact.finger)]
         : forces.other) += force;
  }
  return forces;
}

std::vector<LegendGroup> Legends(const Frame& frame, const HandModel& hand, const Forces& forces,
                                 bool in_view) {
  std::vector<LegendEntry> fingers;
  for (int f = 0; f < hand.num_fingers(); ++f)
    fingers.push_back(
        MarkEntry(fmt::format("{}  {:.2f} N", hand.fingers[f].name, forces.of_finger[f]),
                  Marker::kDisc, LookOfFinger(f).colour));
  if (forces.other > 0)
    fingers.push_back(
        MarkEntry(fmt::format("other links  {:.2f} N", forces.other), Marker::kDisc, kInk));
  const std::vector<LegendEntry> arrow = {
      LegendEntry{"force on the object", [](Canvas* c, Point2 m) {
                    c->Arrow(m - Point2(20, 0), m + Point2(20, 0), {kInk, 3.6});
                  }}};
  const double weight = frame.mass_kg * frame.gravity_W.norm();
  const double carried = weight > 0 ? -forces.sum_W.dot(frame.gravity_W.normalized()) : 0;
  std::vector<LegendEntry> balance = {{fmt::format("weight  {:.3f} N", weight), {}}};
  if (weight > 0)
    balance.push_back(
        {fmt::format("carried now  {:.3f} N", std::abs(carried) < 5e-4 ? 0 : carried), {}});
  balance.push_back({fmt::format("state  {}", Name(frame.state)), {}});
  if (frame.stand_in) balance.push_back({"stand-in holds the object", {}});
  if (!in_view) balance.push_back({"object out of view", {}});
  return {{"contact force, true", fingers, kTop + 4}, {"", arrow}, {"balance", balance}};
}

const std::array<Side, 2> kSides = {Side{{0.22, -1, 0.16}, "from the palm's side"},
                                    Side{{1, -0.32, 0.12}, "from the thumb's side"}};

/// Up on the sheet is up in the world where the direction of view allows it, else towards the
/// fingers.
Vector3d UpFor(const Vector3d& to_viewer, const Vector3d& gravity_W) {
  const Vector3d up =
      gravity_W.norm() > 1e-6 ? Vector3d(-gravity_W.normalized()) : Vector3d(Vector3d::UnitZ());
  return TangentPart(up, to_viewer.normalized()).norm() > 0.45 ? up : Vector3d(Vector3d::UnitZ());
}

void DrawScene(Canvas* canvas, const Frame& frame, const HandModel& hand, const ObjectModel& object,
               const PlotOptions& options, double detail) {
  if (frame.q.size() != hand.num_joints())
    throw std::runtime_error(
        fmt::format("{}: nothing to draw: the frame has {} joint angles, hand {} has {} joints",
                    canvas->path(), frame.q.size(), hand.name, hand.num_joints()));
  if (!frame.q.allFinite())
    throw std::runtime_error(canvas->path() +
                             ": nothing to draw: the frame's joint angles are not finite");
  const bool in_view = ObjectInView(frame, object);
  const double top =
      DrawTitle(canvas, options.title.empty() ? "Hand, object and contact forces" : options.title,
                Facts({&frame, 1}, hand, object.name));
  const Forces forces = ForcesOf(frame, hand);
  const std::vector<LegendGroup> legends = Legends(frame, hand, forces, in_view);
  const Layout layout(*canvas, legends, kNarrowGap);
  layout.DrawLegends(canvas, legends);

  const std::vector<Body> bodies = Bodies(frame, hand, object);
  Vector3d middle = frame.p_WO;  // labels point away from it, scales hold at its depth
  if (!in_view) {
    middle.setZero();
    for (const FingerFrame& finger : frame.fingers)
      middle += finger.true_tip_W / static_cast<double>(frame.fingers.size());
  }
  const std::array<Box, 2> boxes = TwoBoxes(*canvas, layout, canvas->narrow() ? top : kTop, 24);
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const Box& box = boxes[i];
    ViewPainter view(canvas, box, bodies, kSides[i].to_viewer,
                     UpFor(kSides[i].to_viewer, frame.gravity_W), detail);
    canvas->Clip(box);
    for (const Frame::Contact& contact : frame.contacts)
      view.Force(contact.p_WC, contact.force_W, forces.metres_per_newton(),
                 contact.finger >= 0 ? LookOfFinger(contact.finger).colour : kInk);
    for (int f = 0; f < std::min<int>(hand.num_fingers(), static_cast<int>(frame.fingers.size()));
         ++f)
      view.Label(frame.fingers[f].true_tip_W, view.At(middle), hand.fingers[f].name,
                 Shade(LookOfFinger(f).colour, 0.25));
    view.Directions(frame.gravity_W);
    view.Scales(middle, forces.scale(), forces.metres_per_newton());
    canvas->Unclip();
    DrawBorder(canvas, box);
    canvas->Text({box.x + box.width / 2, box.y + 20}, kSides[i].name,
                 {.size = 18, .colour = kGrey, .align_x = AlignX::kCentre, .halo = 2});
  }
}

}  // namespace

void PlotScene(const Frame& frame, const HandModel& hand, const ObjectModel& object,
               const PlotOptions& options, const std::string& path) {
  Canvas canvas(SizeOf(options, kNarrowHeight), path);
  DrawScene(&canvas, frame, hand, object, options, 1);
  canvas.Save();
}

Pixels ScenePixels(const Frame& frame, const HandModel& hand, const ObjectModel& object,
                   const PlotOptions& options) {
  Canvas canvas(SizeOf(options, kNarrowHeight));
  DrawScene(&canvas, frame, hand, object, options, kFilmDetail);
  const std::string bytes = canvas.Bytes();
  return {bytes.begin(), bytes.end()};
}

void DrawScene(const PlotInput& input, const std::string& path) {
  if (input.frames.empty())
    throw std::runtime_error(path + ": nothing to draw: the history is empty");
  PlotScene(input.frames.back(), input.hand, input.object, input.options, path);
}

}  // namespace regrasp
