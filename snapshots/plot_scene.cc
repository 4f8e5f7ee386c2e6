#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/hand/kinematics.h"
#include "snapshots/axes.h"
#include "snapshots/plots.h"
#include "snapshots/refused.h"
#include "snapshots/scene_view.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr Colour kPalm{214, 214, 218}, kObjectLight{244, 236, 212}, kObjectDark{222, 205, 160};
constexpr double kTop = 104;  // of the views on a wide sheet
constexpr double kNarrowHeight = 1050, kNarrowGap = 10;
constexpr double kFilmDetail = 0.75;  // of the bodies; 1.5 x 1.5 samples a pixel instead of 2 x 2
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
      body.radius = object.radius;
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

/// 1 or -1: where the thumb of the stretched hand points along x, to +x on a right hand; 0 where no
/// finger is called so, or it points to neither side.
double ThumbSide(const HandModel& hand) {
  constexpr double kBeside = 5e-3;  // [m]
  const auto thumb = std::ranges::find(hand.fingers, "thumb", &Finger::name);
  if (thumb == hand.fingers.end() || hand.num_fingers() < 2) return 0;
  KinematicsData kinematics;
  ForwardKinematics(hand, JointVector::Zero(hand.num_joints()), &kinematics);
  double others = 0, own = 0;
  for (int f = 0; f < hand.num_fingers(); ++f)
    (f == thumb - hand.fingers.begin() ? own : others) += FingertipCentre(hand, kinematics, f).x();
  const double beside = own - others / (hand.num_fingers() - 1);
  return std::abs(beside) < kBeside ? 0 : std::copysign(1, beside);
}

std::array<Side, 2> SidesOf(const HandModel& hand) {
  const double thumb = ThumbSide(hand);
  return {Side{{0.22, -1, 0.16}, "from the palm's side"},
          Side{{thumb < 0 ? -1.0 : 1.0, -0.32, 0.12},
               thumb == 0 ? "from +x" : "from the thumb's side"}};
}

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
                Facts({&frame, 1}, hand, object.name, options.changed));
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
  const std::array<Side, 2> sides = SidesOf(hand);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Box& box = boxes[i];
    SceneView view(canvas, box, bodies, sides[i].to_viewer,
                   UpFor(sides[i].to_viewer, frame.gravity_W), detail);
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
    canvas->Text({box.x + box.width / 2, box.y + 20}, sides[i].name,
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
  if (input.frames.empty()) throw PictureRefused(path, "nothing to draw: the history is empty");
  PlotScene(input.frames.back(), input.hand, input.object, input.options, path);
}

}  // namespace regrasp
