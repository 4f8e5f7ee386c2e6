/// Creep of held contacts: how fast each contact point wanders over the object while the hand does
/// nothing but hold it. Sessions without sensor noise grasp, settle, and hold; then the contact
/// points in the object's frame are compared over the rest of the run. A point that rolls or slides
/// moves; one that sticks does not.
///
///   bench_creep [--seconds 120] [--settle 6] [--seeds 1] [--first 1] [--objects
///   sphere,egg,cube_40mm]
///               [--stepper both|fast|exact]

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace regrasp {
namespace {

struct Options {
  double seconds = 120, settle = 6;
  int seeds = 1;
  std::uint64_t first = 1;
  std::string objects = "sphere,egg,cube_40mm";
  std::string stepper = "both";
};

struct Contact {
  int count = 0;  ///< contacts of this fingertip
  Vector3d p_OC = Vector3d::Zero();
  double ratio = 0;  ///< tangential over normal force
};

std::array<Contact, kMaxFingers> Look(const WorldState& now) {
  std::array<Contact, kMaxFingers> seen{};
  for (const ObjectContact& c : now.contacts) {
    if (c.finger < 0) continue;
    Contact& to = seen[static_cast<std::size_t>(c.finger)];
    ++to.count;
    to.p_OC = now.q_WO.conjugate() * (c.p_WC - now.p_WO);
    const double normal = -c.force_W.dot(c.normal_W);
    to.ratio = TangentPart(c.force_W, c.normal_W).norm() / normal;
  }
  return seen;
}

/// Prints one row; false where the object was lost.
bool Measure(const std::string& object, Stepper stepper, std::uint64_t seed, const Options& o) {
  SessionConfig config;
  config.model = LoadScenario("shadow", object, ModelSearchPath());
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset("off").value();
  config.seed = seed;
  config.world.stepper = stepper;
  Session session(std::move(config));
  Command grasp;
  grasp.type = CommandType::kGrasp;
  session.Apply(grasp);
  std::printf("%-8s %-6s %4llu ", object.c_str(), stepper == Stepper::kFast ? "fast" : "exact",
              static_cast<unsigned long long>(seed));
  for (int k = 0; k < 20000 && session.state() != SessionState::kHolding; ++k) session.Tick();
  for (int k = 0; k < o.settle * 1000; ++k) session.Tick();
  const auto before = Look(session.truth());
  for (int k = 0; k < o.seconds * 1000; ++k) session.Tick();
  if (session.state() != SessionState::kHolding) {
    std::printf(" lost the object\n");
    return false;
  }
  const auto after = Look(session.truth());
  double worst = 0;
  for (int f = 0; f < session.config().model.hand.num_fingers(); ++f) {
    const Contact &a = before[static_cast<std::size_t>(f)], &b = after[static_cast<std::size_t>(f)];
    if (a.count == 0 || b.count == 0) {
      std::printf("      -     ");
      continue;
    }
    const double creep = 1e6 * (b.p_OC - a.p_OC).norm() / o.seconds;
    worst = std::max(worst, creep);
    std::printf(" %6.2f %4.2f", creep, b.ratio);
  }
  std::printf("   %6.2f\n", worst);
  return true;
}

int Main(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--seconds") {
      o.seconds = std::atof(value);
    } else if (name == "--settle") {
      o.settle = std::atof(value);
    } else if (name == "--seeds") {
      o.seeds = std::atoi(value);
    } else if (name == "--first") {
      o.first = std::strtoull(value, nullptr, 10);
    } else if (name == "--objects") {
      o.objects = value;
    } else if (name == "--stepper") {
      o.stepper = value;
    } else {
      std::fprintf(stderr, "bench_creep: unknown option %s\n", name.c_str());
      return 2;
    }
  }
  std::printf("creep of each contact [um/s] and its tangential / normal force, over %g s\n",
              o.seconds);
  std::printf("%-8s %-6s %4s  %s   worst\n", "object", "step", "seed",
              "fingers in the model's order");
  bool held = true;
  std::istringstream objects(o.objects);
  for (std::string object; std::getline(objects, object, ',');)
    for (int s = 0; s < o.seeds; ++s)
      for (const Stepper stepper : {Stepper::kFast, Stepper::kExact}) {
        if (o.stepper == (stepper == Stepper::kFast ? "exact" : "fast")) continue;
        held = Measure(object, stepper, o.first + static_cast<std::uint64_t>(s), o) && held;
      }
  return held ? 0 : 1;
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) { return regrasp::Main(argc, argv); }
