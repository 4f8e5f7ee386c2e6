#include "cli/top/keys.h"

#include <algorithm>
#include <cctype>
#include <numbers>

#include "cli/print/print.h"
#include "core/common/finger_letters.h"
#include "core/protocol/methods.h"

namespace regrasp::cli {

namespace {

/// What a sensor is like, not how noisy.
bool IsSensor(std::string_view name) {
  return name == "taxel_pitch_m" || name == "object_rate_hz" || name == "object_delay_frames";
}

}  // namespace

Request ChangeNoise(const Json& noise, bool louder) {
  Json levels = Json::object();
  for (const ParamSpec& param : FindMethod("noise.set")->params) {
    if (IsSensor(param.name)) continue;
    const Json& level = At(noise, std::string(param.name).c_str());
    if (!level.is_number() || level.get<double>() <= 0) continue;
    const double next = level.get<double>() * (louder ? 1.25 : 0.8);
    levels[std::string(param.name)] = std::clamp(next, param.min, param.max);
  }
  if (levels.empty()) levels["preset"] = louder ? "fine" : "off";
  return {"noise.set", levels};
}

void Keys::Ask(std::string question, std::vector<Choice> choices) {
  question_ = std::move(question);
  choices_ = std::move(choices);
}

std::optional<Request> Keys::Press(int key, const DashboardModel& model) {
  if (!question_.empty()) {
    const auto chosen = std::find_if(choices_.begin(), choices_.end(), [key](const Choice& choice) {
      return choice.key == std::tolower(key);
    });
    std::optional<Request> request;
    if (chosen != choices_.end()) request = chosen->request;
    Ask("", {});
    return request;
  }
  if (help_) {
    help_ = false;
    if (key != 'q') return {};
  }
  constexpr double kRightAngle = std::numbers::pi / 2;
  switch (key) {
    case 'q':
      quit_ = true;
      return {};
    case '?':
    case 'h':
      help_ = true;
      return {};
    case 'p':
    case ' ':
      return Request{At(model.status(), "paused") == true ? "resume" : "pause"};
    case 'g':
      return Request{"grasp"};
    case 's':
      return Request{"stop"};
    case '+':
    case '=':
    case '-':
      return ChangeNoise(At(model.status(), "noise"), key != '-');
    case 'e': {
      std::vector<Choice> choices;
      const std::vector<std::string> names = model.Fingers();
      const std::vector<char> letters = FingerLetters(names);
      for (std::size_t i = 0; i < names.size(); ++i)
        choices.push_back(
            {std::tolower(letters[i]), names[i], {"explore", {{"finger", names[i]}}}});
      Ask("explore:", choices);
      return {};
    }
    case 'r':
      Ask("rotate:", {{'l', "90° left", {"rotate", {{"angle_rad", kRightAngle}}}},
                      {'r', "90° right", {"rotate", {{"angle_rad", -kRightAngle}}}},
                      {'t', "one turn", {"rotate", {{"turns", 1}}}},
                      {'c', "continuous", {"rotate", {{"continuous", true}}}}});
      return {};
    case 'l':
      Ask("plot:", {{'q', "quality", {"plot", {{"name", "quality"}}}},
                    {'c', "contacts", {"plot", {{"name", "contacts"}}}},
                    {'g', "gait", {"plot", {{"name", "gait"}}}},
                    {'s', "scene", {"plot", {{"name", "scene"}}}}});
      return {};
    case 'x':
      Ask("reset to the start?", {{'y', "yes", {"reset"}}});
      return {};
    case 'f': {
      // Automatic, then one finger after the other.
      const auto names = model.Fingers();
      const auto at = std::find(names.begin(), names.end(), finger_);
      if (finger_.empty()) {
        finger_ = names.empty() ? "" : names.front();
      } else {
        finger_ = at == names.end() || at + 1 == names.end() ? "" : *(at + 1);
      }
      return {};
    }
    default:
      return {};
  }
}

Overlay Keys::Shown() const {
  Overlay overlay;
  overlay.finger = finger_;
  overlay.help = help_;
  if (!question_.empty()) {
    overlay.keys = question_;
    for (const Choice& choice : choices_)
      overlay.items.emplace_back(std::string(1, static_cast<char>(choice.key)), choice.label);
    overlay.items.emplace_back("esc", "nothing");
    return overlay;
  }
  overlay.items = {{"q", "quit"},    {"?", "help"},   {"p", "pause"}, {"g", "grasp"},
                   {"e", "explore"}, {"r", "rotate"}, {"s", "stop"},  {"l", "plot"},
                   {"+-", "noise"},  {"x", "reset"},  {"f", "curve"}};
  return overlay;
}

}  // namespace regrasp::cli
