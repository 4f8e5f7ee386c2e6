#include "cli/experiment/paper_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace regrasp::cli {
namespace {

constexpr std::int64_t kFewer = 5;     // the smaller parts take so many times fewer seeds
constexpr double kOneMotion_deg = 30;  // without a regrasp

Plan Explorations(const PaperSize& size, std::int64_t seeds, int rays) {
  Plan plan;
  plan.experiment = "exploration";
  plan.subjects = {size.finger};
  plan.criterion = "manipulability";
  plan.estimators = {"least_squares", "secant"};
  plan.noise = {"paper"};
  plan.rays = rays;
  plan.seeds = seeds;
  return plan;
}

Plan Rotations(const PaperSize& size, std::int64_t seeds) {
  Plan plan;
  plan.experiment = "rotation";
  plan.subjects = {"0,0,-1"};
  plan.noise = {"paper"};
  plan.turns = size.turns;
  plan.seeds = seeds;
  return plan;
}

std::vector<Case> Cases(std::initializer_list<std::string> texts) {
  std::vector<Case> cases;
  std::transform(texts.begin(), texts.end(), std::back_inserter(cases), ParseCase);
  return cases;
}

}  // namespace

std::vector<PaperPart> PaperParts(const PaperSize& size) {
  const std::int64_t few = std::max<std::int64_t>(1, size.seeds / kFewer);
  std::vector<PaperPart> parts;
  parts.push_back({"exploration", "", "", Explorations(size, size.seeds, size.rays)});
  parts.push_back({"displaced", "", "", Explorations(size, size.seeds, 0)});
  parts.back().plan.common.set = {{"start.displacement_m", "0.003"}};
  parts.push_back({"sweep", "", "", Explorations(size, few, size.rays)});
  parts.back().plan.experiment = "noise-sweep";
  parts.back().plan.noise = {"off", "fine", "paper", "coarse", "taxel"};
  parts.push_back({"returning", "", "", Rotations(size, few)});
  parts.back().plan.common.set = {{"gait.preset", "paper"}, {"gait.mode", "returning"}};
  parts.push_back({"exploring", "", "", Rotations(size, few)});
  parts.back().plan.common.set = {{"gait.preset", "paper"}};
  parts.push_back({"planned", "", "", Rotations(size, few)});

  const auto add = [&](const char* name, const char* title, const std::string& text) {
    parts.push_back({name, title, text, Rotations(size, few)});
    return &parts.back().plan;
  };
  Plan* plan = add("axes", "Every axis",
                   "The paper turns the object about one axis. Here about all six, landings "
                   "planned (the default).");
  plan->subjects = {"1,0,0", "-1,0,0", "0,1,0", "0,-1,0", "0,0,1", "0,0,-1"};
  plan = add(
      "one-motion", "How far one motion goes",
      fmt::format("The local manipulation controller alone: {}° in one step of the gait. A finger "
                  "that comes to its limit regrasps on the way.",
                  kOneMotion_deg));
  plan->subjects = {"1,0,0", "-1,0,0", "0,1,0", "0,-1,0", "0,0,1", "0,0,-1"};
  plan->turns = kOneMotion_deg / 360;
  plan->common.set = {{"gait.step_rad", "0.6"}, {"gait.lead", "0"}, {"gait.margin_wanted", "0"}};
  plan = add("noise", "Rotation against noise", "Every preset of sensor noise, landings planned.");
  plan->noise = {"off", "fine", "paper", "coarse", "taxel"};
  plan =
      add("tilt", "Tilt of the hand",
          "0°: palm up; 90°: fingers down; all else here is at 65°. Landings planned. The last row "
          "leaves out "
          "the search for contacts that let the thumb leave, which comes before the first motion.");
  plan->cases = Cases({"tilt 0: tilt=0", "tilt 15: tilt=15", "tilt 30: tilt=30", "tilt 45: tilt=45",
                       "tilt 60: tilt=60", "tilt 75: tilt=75", "tilt 90: tilt=90",
                       "tilt 45, no search: tilt=45 gait.max_shift=0"});
  plan = add("conditions", "Pushes, other objects, masses and friction",
             "Nothing is tuned for these. Pushes: each second for 0.1 s in a random direction. "
             "Landings planned.");
  plan->cases = Cases(
      {"sphere of 5 cm, 80 g, friction 0.8:", "pushes of 0.5 N: push=0.5", "pushes of 1 N: push=1",
       "30 g: object.mass_kg=0.03", "150 g: object.mass_kg=0.15", "300 g: object.mass_kg=0.3",
       "friction 0.4: object.friction=0.4", "friction 0.6: object.friction=0.6",
       "friction 1: object.friction=1", "sphere of 4 cm: object=sphere_40mm",
       "sphere of 4.5 cm: object=sphere_45mm", "sphere of 6 cm: object=sphere_60mm",
       "egg: object=egg", "cube of 4 cm: object=cube_40mm",
       "cube, no load margin: object=cube_40mm gait.margin_min=0 gait.margin_wanted=0",
       "1 N, no load margin: push=1 gait.margin_min=0 gait.margin_wanted=0"});
  plan = add("long", "Longer and faster",
             "Five turns with each gait, a longer exploration, and settings for speed.");
  plan->cases = Cases(
      {fmt::format("planned, 5 turns: turns={}", 5 * size.turns),
       fmt::format("returning, 5 turns: turns={} gait.preset=paper gait.mode=returning",
                   5 * size.turns),
       fmt::format("exploring, 5 turns: turns={} gait.preset=paper", 5 * size.turns),
       fmt::format("exploring for 1 s: turns={} gait.preset=paper gait.explore_s=1", size.turns),
       fmt::format("planned and exploring: turns={} gait.mode=exploring", size.turns),
       "returning, fastest: gait.preset=paper gait.mode=returning gait.step_rad=0.5236 "
       "gait.speed_rad_s=0.7"});
  plan = add("ablations", "Ablations",
             "The exploring gait without one of its parts, and a plain return to the first contact "
             "in place of every exploration. In the last two rows a motion goes on until a finger "
             "can follow no further: what exploring gains in how far the object turns.");
  plan->common.set = {{"gait.preset", "paper"}};
  plan->cases =
      Cases({"complete:", "no excursion bound: gait.disc_radius=0.02",
             "no load margin: gait.margin_min=0 gait.margin_wanted=0",
             "no load transfer: gait.transfer_s=0.001",
             "printed gradient rule: gait.estimator=secant", "plain return: gait.mode=returning",
             "exploring, as far as it goes: gait.step_rad=1.2 gait.lead=0.145",
             "plain return, as far as it goes: gait.step_rad=1.2 gait.lead=0.145 "
             "gait.mode=returning"});
  for (PaperPart& part : parts) {
    part.plan.first_seed = size.seed;
    part.plan.models_dir = size.models_dir;
  }
  return parts;
}

}  // namespace regrasp::cli
