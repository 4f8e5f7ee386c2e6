// Searches the preshape and closed posture of a hand from those its scenario has (from nothing:
// regrasp hand new).
//   posture [--hand NAME] [--seed S] [--steps N] [--radius MM] [--tilt DEG] [--reach 0..1]
//           [--keep 1]   keeps the scenario's object, closed posture and touch; only the way in
// Prints TOML and, as comments, the figures of the grasp.

#include <cmath>
#include <cstdio>
#include <string>

#include "core/hand/scenario.h"
#include "core/posture/grasp_search.h"
#include "core/posture/way_in.h"

using namespace regrasp;

namespace {

void PrintPosture(const char* table, const HandModel& hand, const JointVector& q) {
  std::printf("\n[%s]\n", table);
  for (int j = 0; j < hand.num_joints(); ++j)
    std::printf("\"%s\" = %.2f\n", hand.joints[static_cast<std::size_t>(j)].name.c_str(),
                q[j] * 180 / M_PI);
}

}  // namespace

int main(int argc, char** argv) {
  std::string name = "shadow";
  GraspSearch search;
  search.steps = 20000;
  double tilt = 65;
  bool keep = false;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string a = argv[i];
    if (a == "--hand") name = argv[i + 1];
    if (a == "--seed") search.seed = std::stoull(argv[i + 1]);
    if (a == "--steps") search.steps = std::stoi(argv[i + 1]);
    if (a == "--radius") search.task.radius = std::stod(argv[i + 1]) * 1e-3;
    if (a == "--reach") search.reach = std::stod(argv[i + 1]);
    if (a == "--keep") keep = std::stoi(argv[i + 1]) != 0;
    if (a == "--tilt") tilt = std::stod(argv[i + 1]);
  }
  const LoadedScenario model = LoadScenario(name, "", ModelSearchPath());
  const HandModel& hand = model.hand;
  search.task.weight =
      0.08 * 9.81 * Vector3d(0, std::cos(tilt * M_PI / 180), std::sin(tilt * M_PI / 180));
  BallGrasp start;
  start.q = 0.5 * (model.scenario.q_preshape + model.scenario.q_closed);
  start.p_WO = model.scenario.X_WO.translation();
  if (keep) search.steps = 0;
  const BallGrasp best = ClimbGrasp(hand, search, start);
  RandomStream random(search.seed, 2);
  const WayIn way = FindWayIn(hand, search.task, best, 20, &random);
  std::printf(
      "# score %.3f, clearance %.1f mm (on the way %.1f), room to limits %.2f, sigma_min "
      "%.4f m, room to climb %.1f %%, load margin %.2f N, without",
      best.score, best.clearance * 1e3, way.gap * 1e3, best.room, best.sigma, 100 * best.climb,
      best.load_margin);
  for (int f = 0; f < hand.num_fingers(); ++f)
    std::printf(" %s %.2f N", hand.fingers[static_cast<std::size_t>(f)].name.c_str(),
                best.margin_without[static_cast<std::size_t>(f)]);
  std::printf("\n[object_pose]\nposition_m = [%.5f, %.5f, %.5f]\n", best.p_WO.x(), best.p_WO.y(),
              best.p_WO.z());
  PrintPosture("q_preshape_deg", hand, way.open);
  PrintPosture("q_closed_deg", hand, way.closed);
}
