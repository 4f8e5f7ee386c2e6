#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/hand/hand_command.h"
#include "core/common/count_text.h"
#include "core/files/names.h"
#include "core/posture/hand_guess.h"
#include "core/session/few_fingers.h"
#include "core/session/session.h"
#include "core/world/stepper_choice.h"
#include "snapshots/snapshots.h"

namespace regrasp::hand {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kSaidFit = 1e-3;  // [m]: a fingertip farther from its mesh is told

struct Loaded {
  LoadedScenario model;
  std::string urdf, scenario;
  std::vector<std::string> notes;
};

/// A hand without a scenario stands at rest, far from the ball.
LoadedScenario AtRest(const std::filesystem::path& urdf, const HandGuess& guess,
                      const LoadOptions& options) {
  LoadedScenario model;
  HandLayout layout = guess.layout;
  layout.armature = 2e-4;
  model.hand = LoadHand(urdf, layout, options, &model.report);
  model.hand.name = urdf.stem().string();
  model.scenario.name = model.scenario.hand = model.hand.name;
  model.scenario.q_preshape = JointVector::Zero(model.hand.num_joints());
  model.scenario.q_closed = model.scenario.q_preshape;
  for (int j = 0; j < model.hand.num_joints(); ++j) {
    const Joint& joint = model.hand.joints[static_cast<std::size_t>(j)];
    model.scenario.q_preshape[j] = std::clamp(0.0, joint.lower, joint.upper);
    model.scenario.q_closed[j] = 0.5 * (joint.lower + joint.upper);
  }
  model.scenario.X_WO.translation() = Vector3d(0, 1, 0);
  model.object = LoadObject("sphere", ModelSearchPath(), {});
  model.scenario.object = model.object.name;
  return model;
}

Loaded Load(const Options& options) {
  const HandFiles files = FindHandFiles(options.file, ModelSearchPath());
  Loaded loaded;
  loaded.urdf = files.urdf.string();
  loaded.scenario = files.scenario.string();
  if (!files.scenario.empty()) {
    loaded.model = LoadScenario(options.file, "", ModelSearchPath(), options.load());
    return loaded;
  }
  const HandGuess guess = GuessHand(files.urdf);
  loaded.notes = guess.notes;
  loaded.model = AtRest(files.urdf, guess, options.load());
  return loaded;
}

/// Contacts of the hand's links with each other in the preshape.
int OwnContacts(const LoadedScenario& model) {
  World world(model.hand, model.object, {}, model.scenario.q_preshape, model.scenario.X_WO);
  world.SetGravity(Vector3d::Zero());
  return world.Step() == StepStatus::kOk ? world.state().link_link_contacts : 0;
}

Json JointJson(const HandModel& hand, int j) {
  const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
  Json json = {{"name", joint.name},
               {"lower_rad", joint.lower},
               {"upper_rad", joint.upper},
               {"effort_nm", joint.effort},
               {"damping_nm_s_rad", joint.damping},
               {"armature_kg_m2", joint.armature}};
  if (joint.driver >= 0) {
    json["driver"] = hand.joints[static_cast<std::size_t>(joint.driver)].name;
    json["ratio"] = joint.ratio;
  }
  return json;
}

std::string JointLine(const HandModel& hand, int j) {
  const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
  std::string line =
      fmt::format("    {:<24} {:7.1f} .. {:6.1f} deg  {:5.2g} N m  {:5.2g} N m s/rad", joint.name,
                  joint.lower / kDegree, joint.upper / kDegree, joint.effort, joint.damping);
  if (joint.driver >= 0)
    line += fmt::format("  follows {} x {:.3g}",
                        hand.joints[static_cast<std::size_t>(joint.driver)].name, joint.ratio);
  return line;
}

Json FingersJson(const HandModel& hand) {
  Json fingers = Json::array();
  for (const Finger& finger : hand.fingers) {
    Json joints = Json::array();
    for (const int j : finger.joints)
      joints.push_back(hand.joints[static_cast<std::size_t>(j)].name);
    fingers.push_back({{"name", finger.name},
                       {"tip_link", hand.links[static_cast<std::size_t>(finger.tip_link)].name},
                       {"tip_radius_m", finger.tip_radius},
                       {"joints", joints}});
  }
  return fingers;
}

std::string FingersText(const HandModel& hand) {
  std::string text;
  for (const Finger& finger : hand.fingers) {
    text += fmt::format("\n  {}: tip of {} with radius {:.1f} mm, {}", finger.name,
                        hand.links[static_cast<std::size_t>(finger.tip_link)].name,
                        1e3 * finger.tip_radius, DrivenJoints(finger));
    for (const int j : finger.joints) text.append("\n").append(JointLine(hand, j));
  }
  if (hand.num_coupled > 0) text += "\n  coupled joints";
  for (int j = hand.num_joints(); j < hand.num_joints() + hand.num_coupled; ++j)
    text.append("\n").append(JointLine(hand, j));
  return text;
}

Json FitsJson(const ModelReport& report) {
  Json fits = Json::array();
  for (const ShapeFit& fit : report.fits)
    fits.push_back({{"link", fit.link},
                    {"mesh", fit.mesh},
                    {"shape", fit.shape},
                    {"error_m", fit.error_m},
                    {"rms_m", fit.rms_m},
                    {"fingertip", fit.fingertip}});
  return fits;
}

std::string FitsText(const ModelReport& report) {
  if (report.fits.empty()) return "";
  std::string text = "\nmeshes as shapes (largest distance):";
  for (const ShapeFit& fit : report.fits)
    text += fmt::format("\n  {:<24} {:<8} {:5.1f} mm{}{}", fit.link, fit.shape, 1e3 * fit.error_m,
                        fit.fingertip ? ", fingertip" : "",
                        fit.fingertip && fit.error_m > kSaidFit ? " (more than 1 mm)" : "");
  return text;
}

/// What loads, but may surprise.
std::vector<std::string> Warnings(const Loaded& loaded, int own_contacts) {
  std::vector<std::string> warnings;
  for (const ModelWarning& warning : loaded.model.report.warnings)
    warnings.push_back(warning.Line());
  if (own_contacts > 0)
    warnings.push_back(
        fmt::format("in the {} posture links of different fingers touch in {} places",
                    loaded.scenario.empty() ? "rest" : "preshape", own_contacts));
  for (const Finger& finger : loaded.model.hand.fingers)
    if (!PlacesItsTip(finger))
      warnings.push_back(
          fmt::format("finger {} has {}: it can hold, but a tip needs 3 to slide where it shall",
                      finger.name, DrivenJoints(finger)));
  if (const std::string shared = SharedMotors(loaded.model.hand); !shared.empty())
    warnings.push_back(shared);
  const std::string_view few = FewFingers(loaded.model.hand.num_fingers());
  if (!few.empty()) warnings.emplace_back(few);
  return warnings;
}

}  // namespace

std::string SharedMotors(const HandModel& hand) {
  int own = 0;
  for (const Finger& finger : hand.fingers) {
    const auto alone = [&](int j) {
      return std::ranges::count_if(hand.fingers, [&](const Finger& other) {
               return std::ranges::count(other.joints, j) > 0;
             }) == 1;
    };
    own += std::ranges::any_of(finger.joints, alone);
  }
  const int needed = std::min(3, hand.num_fingers());
  if (own >= needed) return "";
  return fmt::format(
      "{} of {} fingers {} a motor of {} own: those that follow one motor cannot each be put on an "
      "object; {} are needed",
      own, hand.num_fingers(), own == 1 ? "has" : "have", own == 1 ? "its" : "their", needed);
}

std::string DrivenJoints(const Finger& finger) {
  return CountText(finger.joints.size(), "driven joint");
}

std::string_view FewFingers(int fingers) {
  if (fingers < 3)
    return "two fingers: nothing keeps the object from turning about the line between them; none "
           "can leave the grasp, so the hand does not explore or regrasp";
  if (fingers == 3)
    return "three fingers: none can leave the grasp, so the hand holds and moves an object but "
           "does "
           "not explore or regrasp";
  return "";
}

void DrawHand(const LoadedScenario& model, const std::string& scenario, const std::string& file) {
  SessionConfig config;
  config.model = model;
  config.parameters = DefaultParameters(model);
  Session session(config);
  session.Tick();
  Frame frame;
  session.Snapshot(&frame, false);
  PlotOptions options;
  options.title = model.hand.name + (scenario.empty() ? ", all joints at 0" : " in its preshape");
  PlotScene(frame, model.hand, model.object, options, file);
}

Answer CheckHand(const Options& options) {
  const Loaded loaded = Load(options);
  const HandModel& hand = loaded.model.hand;
  const StepperChoice choice = ChooseStepper(loaded.model, {});
  const std::string_view stepper = Name(choice.stepper);
  const int own = OwnContacts(loaded.model);
  const std::vector<std::string> warnings = Warnings(loaded, own);
  double mass = 0;
  for (const Link& link : hand.links) mass += link.mass;

  Answer answer;
  if (!choice.works) answer.code = ExitCode::kFailed;
  answer.json = {{"urdf", loaded.urdf},
                 {"scenario", loaded.scenario.empty() ? Json() : Json(loaded.scenario)},
                 {"hand", hand.name},
                 {"mass_kg", mass},
                 {"fingers", FingersJson(hand)},
                 {"joints", Json::array()},
                 {"fits", FitsJson(loaded.model.report)},
                 {"own_contacts", own},
                 {"stepper", stepper},
                 {"stepper_reason", choice.reason},
                 {"moves", choice.works},
                 {"warnings", warnings}};
  for (int j = 0; j < hand.num_joints() + hand.num_coupled; ++j)
    answer.json["joints"].push_back(JointJson(hand, j));
  answer.text = fmt::format(
      "{}: {}, {}, {} coupled, {}, {:.0f} g\n  {}\n  scenario: {}", ShownText(hand.name),
      CountText(hand.num_fingers(), "finger"), CountText(hand.num_joints(), "driven joint"),
      hand.num_coupled, CountText(hand.links.size(), "link"), 1e3 * mass, ShownText(loaded.urdf),
      loaded.scenario.empty() ? "none    (regrasp hand new)" : ShownText(loaded.scenario));
  for (const std::string& note : loaded.notes)
    if (!note.starts_with("finger ")) answer.text += "\n  " + note;
  answer.text += FingersText(hand) + FitsText(loaded.model.report);
  answer.text += choice.works ? fmt::format("\nstepper: {} ({})", stepper, choice.reason)
                              : fmt::format(
                                    "\nstepper: none: {}; look at its masses, inertias and "
                                    "armature_kg_m2",
                                    choice.reason);
  for (const std::string& warning : warnings) answer.text += "\nwarning: " + warning;
  if (options.Has("--output")) {
    DrawHand(loaded.model, loaded.scenario, options.Text("--output"));
    answer.json["picture"] = options.Text("--output");
    answer.text += "\npicture: " + options.Text("--output");
  }
  return answer;
}

}  // namespace regrasp::hand
