#include "cli/hand/sheet.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/hand/scenario_file.h"
#include "core/files/names.h"
#include "core/session/few_fingers.h"

namespace regrasp::hand {
namespace {

constexpr double kOpposes = 0.05;  // [N]: a load margin that counts

}  // namespace

std::string Sheet::ScoreLine() const {
  const BallGrasp& g = best.grasp;
  std::string line =
      fmt::format("Load margin {:.2f} N{}; without", g.load_margin, ball ? "" : " of " + StandIn());
  for (std::size_t f = 0; f < best.model.hand.fingers.size(); ++f)
    line += fmt::format("{} {} {:.2f}", f == 0 ? "" : ",", best.model.hand.fingers[f].name,
                        std::max(0.0, g.margin_without[f]));
  return line + fmt::format(" N. Room to limits {:.2f}, clearance {:.1f} mm.", g.room,
                            1e3 * std::min(g.clearance, best.way.gap));
}

std::string Sheet::StandIn() const {
  return fmt::format("the ball of {:g} mm that stands for the object", ball_mm);
}

std::string Sheet::Tried() const {
  if (!best.trial.held) return "tried: does not hold";
  std::string told =
      fmt::format("tried with {} seeds: holds {} for {:g} s, moved {:.2f} mm at most", kTrials,
                  best.model.scenario.object, kHold, 1e3 * best.trial.moved_m);
  if (const UseTrial& use = best.use; use.any())
    told += fmt::format(
        "\n  with {}: exploring raises phi in {} of {}; {} of {} turns, {} within {:g} mm and "
        "{:g}°",
        use.turns, use.rose, use.explorations, use.turned, use.turns, use.clean, kCleanOffset,
        kCleanTilt);
  return told;
}

Json Sheet::Used() const {
  const UseTrial& use = best.use;
  if (!use.any()) return nullptr;
  Json stayed = Json::object();
  for (std::size_t f = 0; f < best.model.hand.fingers.size(); ++f)
    stayed[best.model.hand.fingers[f].name] = use.stayed[f];
  return {{"explorations", use.explorations},
          {"rose", use.rose},
          {"may_not_leave", stayed},
          {"turns", use.turns},
          {"turned", use.turned},
          {"clean", use.clean}};
}

/// What was tried with it and does not work.
void Sheet::AddUseRemarks(std::vector<std::string>* remarks) const {
  const UseTrial& use = best.use;
  if (!use.any()) return;
  const char* object = ball ? "the ball" : "the object";
  if (use.turned == 0)
    remarks->push_back(
        fmt::format("none of {} turns was completed: the hand holds {}, and does not turn it",
                    use.turns, object));
  if (2 * use.rose < use.explorations)
    remarks->push_back(
        fmt::format("exploring raised phi in {} of {} only", use.rose, use.explorations));
  for (std::size_t f = 0; f < best.model.hand.fingers.size(); ++f)
    if (use.stayed[f] > 0)
      remarks->push_back(
          fmt::format("{} may not leave in {} of {}: without it the others hold too little of {}",
                      best.model.hand.fingers[f].name, use.stayed[f], use.turns, object));
}

std::vector<std::string> Sheet::Remarks() const {
  std::vector<std::string> remarks;
  const BallGrasp& g = best.grasp;
  const std::string held = ball ? "the ball" : StandIn();
  if (g.load_margin < kOpposes)
    remarks.push_back(fmt::format(
        "no finger opposes the others: the fingertips cannot hold {} against every small push",
        held));
  AddUseRemarks(&remarks);
  for (const std::string& name : left_out)
    remarks.push_back(
        fmt::format("{} is left out and locked: with it no grasp was found that holds", name));
  const std::string_view few = FewFingers(best.model.hand.num_fingers());
  if (!few.empty()) remarks.emplace_back(few);
  for (std::size_t f = 0; few.empty() && f < best.model.hand.fingers.size(); ++f)
    if (g.load_margin >= kOpposes && g.margin_without[f] < kOpposes)
      remarks.push_back(
          fmt::format("without {} the others cannot hold {}: it will not be allowed to leave",
                      best.model.hand.fingers[f].name, held));
  for (const Finger& finger : best.model.hand.fingers)
    if (!PlacesItsTip(finger))
      remarks.push_back(
          fmt::format("{} has {}: it holds, but can neither slide nor be placed: "
                      "it does not explore, and the hand turns no farther than gait.step_rad (20°)",
                      finger.name, DrivenJoints(finger)));
  if (g.clearance < 0)
    remarks.push_back(fmt::format(
        "links of the hand overlap each other, or {}, by {:.1f} mm in the closed posture", held,
        -1e3 * g.clearance));
  if (best.way.stuck >= 0)
    remarks.push_back(
        fmt::format("{} finds no straight way to its contact within its limits",
                    best.model.hand.fingers[static_cast<std::size_t>(best.way.stuck)].name));
  if (!best.trial.held)
    remarks.push_back(
        ball ? fmt::format("held with {} of {} seeds, then: {}", best.trial.seeds, kTrials,
                           best.trial.end)
             : fmt::format("{} ways to lay {} in were tried with up to {} seeds, and none held; "
                           "the one written: {}",
                           ways, best.model.scenario.object, kTrials, best.trial.end));
  for (const ModelWarning& warning : report.warnings) remarks.push_back(warning.Line());
  return remarks;
}

Answer Sheet::Tell() const {
  const BallGrasp& g = best.grasp;
  const std::string_view stepper = Name(best.choice.stepper);
  const std::vector<std::string> remarks = Remarks();
  Answer answer;
  Json fingers = Json::array();
  // phi as `quality` tells it.
  std::string table = fmt::format("\n  {:<10} {:>15}{} {:>14}  {}", "finger",
                                  ball ? "rho without [N]" : "ball: rho w/o [N]",
                                  ball ? "" : "  held: rho w/o [N]", "phi [1e-4 m3]", "tip");
  for (std::size_t f = 0; f < best.model.hand.fingers.size(); ++f) {
    const Finger& finger = best.model.hand.fingers[f];
    const std::string& tip = guess.layout.fingers[f].tip_link;
    fingers.push_back(
        {{"name", finger.name},
         {"tip_link", tip},
         {"load_margin_without_n", std::max(0.0, g.margin_without[f])},
         {"held_load_margin_without_n", best.trial.held ? Json(best.trial.without_n[f]) : Json()},
         {"manipulability", g.manipulability[f]},
         {"phi", 1e4 * g.manipulability[f]},
         {"opposing", static_cast<int>(f) == g.opposing}});
    const std::string as_held = ball ? ""
                                : best.trial.held
                                    ? fmt::format(" {:>20.2f}", best.trial.without_n[f])
                                    : fmt::format(" {:>20}", "-");
    table += fmt::format("\n  {:<10} {:>{}.2f}{} {:>14.3f}  {}{}", finger.name,
                         std::max(0.0, g.margin_without[f]), ball ? 15 : 17, as_held,
                         1e4 * g.manipulability[f], tip,
                         static_cast<int>(f) == g.opposing ? "    opposing" : "");
  }
  answer.json = {{"file", file.string()},
                 {"urdf", urdf.string()},
                 {"object", best.model.scenario.object},
                 {"ball_file", ball_file.empty() ? Json() : Json(ball_file)},
                 {"seed", seed},
                 {"score", g.score},
                 {"load_margin_n", g.load_margin},
                 {"ball_m", 1e-3 * ball_mm},
                 {"held_load_margin_n", best.trial.held ? Json(best.trial.with_all_n) : Json()},
                 {"fingers", fingers},
                 {"room_to_limits", g.room},
                 {"clearance_m", std::min(g.clearance, best.way.gap)},
                 {"held", best.trial.held},
                 {"hold_end", best.trial.end},
                 {"moved_m", best.trial.moved_m},
                 {"used", Used()},
                 {"stepper", stepper},
                 {"stepper_reason", best.choice.reason},
                 {"remarks", remarks},
                 {"notes", guess.notes}};
  answer.text = fmt::format(
      "{}: load margin {:.2f} N{}, room to joint limits {:.2f}, clearance {:.1f} mm{}\n  {}\n  "
      "stepper {}: {}",
      ShownText(file.string()), g.load_margin, ball ? "" : " of " + StandIn(), g.room,
      1e3 * std::min(g.clearance, best.way.gap), table, Tried(), stepper, best.choice.reason);
  if (!ball_file.empty())
    answer.text +=
        fmt::format("\n  {} beside it: a ball of {:g} mm and {:g} g", ShownText(ball_file),
                    2e3 * best.model.object.radius, 1e3 * best.model.object.mass);
  for (const std::string& remark : remarks) answer.text += "\n  note: " + remark;
  answer.text +=
      best.trial.held
          ? fmt::format("\n  next: regrasp up --hand {}", ShownText(ShellWord(file.string())))
          : fmt::format("\n  next: regrasp hand new {} -o OTHER.toml with another --seed or {}",
                        ShownText(ShellWord(urdf.string())), ball ? "--object-size" : "--object");
  return answer;
}

}  // namespace regrasp::hand
