#include "cli/experiment/phi_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>

#include "cli/client/errors.h"
#include "cli/experiment/straight_slide.h"
#include "cli/print/print.h"
#include "core/exploration/criterion.h"

namespace regrasp::cli {
namespace {

constexpr std::int64_t kSampleTicks = 50;  // 0.75 mm at 15 mm/s
// Of the time that the straight way to the excursion bound takes: a wall is slid along, slowly.
constexpr double kTimeShare = 4;
// A contact that moved less than this in so many samples has arrived, at the bound or in a corner.
constexpr double kStill_m = 4e-4;
constexpr std::size_t kStillSamples = 6;
constexpr std::int64_t kTransferLimit = 5000;  // load transfer before and after [ticks]
constexpr double kTick_s = 1e-3;

std::array<double, 3> Point(const Json& json) { return {json.at(0), json.at(1), json.at(2)}; }

double Distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

void Ray(SteppedDaemon* daemon, const std::string& finger, const std::string& criterion, int ray,
         std::int64_t direction_seed, int cycles, PhiMap* map) {
  const Json job = daemon->Call("explore", {{"finger", finger},
                                            {"criterion", criterion},
                                            {"estimator", "secant"},
                                            {"seed", direction_seed},
                                            {"max_cycles", cycles + 1}});  // one to stop at
  Json begin;
  bool slid = false;
  std::deque<std::array<double, 3>> last;
  for (std::int64_t tick = 0; tick < cycles + kTransferLimit; tick += kSampleTicks) {
    daemon->Step(kSampleTicks);
    const Json quality = daemon->Call("quality", {{"measures", "frame"}});
    const Json& exploration = At(quality, "exploration");
    const bool sliding = exploration.is_object() && exploration.at("cycle").get<int>() > 0;
    if (!sliding && slid) return;
    if (!sliding) continue;
    if (exploration.at("cycle").get<int>() > cycles) return;
    const Json truth = daemon->Call("truth");
    const Json& point = truth.at("fingers").at(finger).at("p_WC_m");
    const std::string truth_name = TruthNameOf(criterion);
    const Json& phi =
        truth_name.empty() ? exploration.at("phi") : truth.at("fingers").at(finger).at(truth_name);
    if (point.is_null() || !phi.is_number()) continue;
    if (!slid) {
      slid = true;
      begin = point;
      ++map->rays;
    }
    map->samples.push_back({{"ray", ray}, {"p_WC_m", point}, {"phi", phi}});
    if (phi.get<double>() > map->best) {
      map->best = phi;
      map->distance_m = Distance(Point(point), Point(begin));
    }
    last.push_back(Point(point));
    if (last.size() <= kStillSamples) continue;
    last.pop_front();
    if (Distance(last.front(), last.back()) < kStill_m) return;
  }
}

}  // namespace

std::string TruthNameOf(const std::string& criterion) {
  const CriterionInfo* const row = FindCriterion(criterion);
  return row ? std::string(row->truth) : "";
}

PhiMap MapPhi(SteppedDaemon* daemon, const std::string& noise, std::int64_t seed,
              const std::string& finger, const std::string& criterion, int rays) {
  PhiMap map;
  map.samples = Json::array();
  daemon->LeaveFault();
  const auto parameter = [&](const char* name) {
    return daemon->Call("param.get", {{"name", name}}).at("value");
  };
  std::array<Json, kStraightSlide.size()> before;
  for (std::size_t i = 0; i < kStraightSlide.size(); ++i)
    before[i] = parameter(kStraightSlide[i].first);
  const double way_s = parameter("exploration.max_excursion").get<double>() /
                       parameter("exploration.speed_max").get<double>();
  const int cycles = static_cast<int>(std::ceil(kTimeShare * way_s / kTick_s));
  for (int ray = 0; ray < rays; ++ray) {
    daemon->Call("noise.set", {{"preset", noise}});
    if (!Done(daemon->Grasp(seed))) break;
    daemon->Call("noise.set", {{"preset", "off"}});
    for (const auto& [name, value] : kStraightSlide)
      daemon->Call("param.set", {{"name", name}, {"value", value}});
    Ray(daemon, finger, criterion, ray, SeedOfDirection(2 * std::numbers::pi * ray / rays), cycles,
        &map);
    daemon->LeaveFault();
    for (std::size_t i = 0; i < kStraightSlide.size(); ++i)
      daemon->Call("param.set", {{"name", kStraightSlide[i].first}, {"value", before[i]}});
  }
  daemon->LeaveFault();
  daemon->Call("noise.set", {{"preset", noise}});
  return map;
}

}  // namespace regrasp::cli
