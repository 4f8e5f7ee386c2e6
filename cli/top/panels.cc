#include "cli/top/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cli/print/print.h"
#include "core/common/count_text.h"
#include "core/common/finger_letters.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
/// Closer than this to a joint limit is shown as a warning [rad].
constexpr double kNearLimit = 3 / kDegrees;
constexpr double kFarFromLimit = 30 / kDegrees;  ///< a full bar [rad]

double Number(const Json& value, double otherwise = 0) {
  return value.is_number() ? value.get<double>() : otherwise;
}

std::string Upper(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

std::string Microseconds(const Json& seconds) {
  return seconds.is_number() ? fmt::format("tick p99 {} µs", Fixed(seconds, 0, 1e6)) : "";
}

std::string Recording(const Json& recording) {
  if (recording.is_null() || recording == false) return "rec off";
  if (recording.is_string()) return "● rec " + recording.get<std::string>();
  for (const char* key : {"run", "name", "file"})
    if (At(recording, key).is_string()) return "● rec " + Plain(At(recording, key));
  return "● rec on";
}

std::string JobText(const Json& job) {
  if (!job.is_object()) return "no job yet";
  std::string text = fmt::format("job {} {}", Plain(At(job, "id")), Plain(At(job, "method")));
  if (At(job, "finger").is_string()) text += " " + Plain(At(job, "finger"));
  if (At(job, "state") == "running") {
    return text + fmt::format(" {} {:.0f} %", FineBar(Number(At(job, "progress")), 8),
                              100 * Number(At(job, "progress")));
  }
  return text + " " + Plain(At(job, "state"));
}

/// Label in the first 9 columns of a one-row panel; the box to the right of it.
Box Labelled(Screen* screen, const Box& box, const char* label) {
  constexpr int kLabel = 9;
  if (box.columns < 4 * kLabel) return box;
  screen->Put(box.row, box.column, label, Ink::kTitle, kLabel);
  return {box.row, box.column + kLabel, 1, box.columns - kLabel};
}

Ink RoleInk(const std::string& role) {
  return role == "explore" ? Ink::kWarn
         : role == "move"  ? Ink::kBold
         : role == "hold"  ? Ink::kGood
                           : Ink::kDim;
}

/// A column of the table of fingers.
struct Column {
  std::string heading;
  int width;
  int rank;  ///< the highest goes first when they do not all fit
  int gap = 2;
};
enum { kName, kRole, kContact, kForce, kForceBar, kLimit, kLimitBar, kPhi, kPhiBar };

/// The columns that fit; width 0 for the others. Bars share what is left over.
std::vector<Column> FingerColumns(int width) {
  std::vector<Column> columns = {{"FINGER", 8, 0, 1}, {"ROLE", 9, 2},     {"CONTACT", 7, 3},
                                 {"FORCE", 6, 1},     {"", 0, 6, 1},      {"LIMIT", 6, 4},
                                 {"", 0, 8, 1},       {"MANIP. φ", 8, 5}, {"", 0, 7, 1}};
  const auto total = [&columns] {
    int sum = 0;
    for (const Column& c : columns) sum += c.width > 0 ? c.gap + c.width : 0;
    return sum;
  };
  while (total() > width && total() > 1 + columns[kName].width) {
    std::max_element(columns.begin(), columns.end(), [](const Column& a, const Column& b) {
      return std::pair(a.width > 0, a.rank) < std::pair(b.width > 0, b.rank);
    })->width = 0;
  }
  constexpr int kShortest = 4, kLongest = 16;
  const std::size_t bars[] = {kForceBar, kPhiBar, kLimitBar};
  for (std::size_t count = std::size(bars); count > 0; --count) {
    const int bar = (width - total()) / static_cast<int>(count) - 1;
    if (bar < kShortest) continue;
    for (std::size_t i = 0; i < count; ++i) columns[bars[i]].width = std::min(bar, kLongest);
    break;
  }
  return columns;
}

/// How fast time goes on, or why it does not.
std::string Speed(const Json& status) {
  if (const Json& factor = At(status, "real_time_factor"); factor.is_number() && factor != 0.0)
    return Fixed(factor, 2) + "× real time";
  const bool waits = At(status, "clock") == "lockstep" && At(status, "advancing") == false &&
                     At(status, "paused") != true && At(status, "state") != "faulted";
  return waits ? "waits for a job" : "";
}

}  // namespace

void DrawHeader(Screen* screen, const Box& box, const DashboardModel& model) {
  const Json& s = model.status();
  const std::string state = Plain(At(s, "state"));
  const bool paused = At(s, "paused") == true;
  const bool bad = state == "dropped" || state == "faulted";
  PutItems(screen, {box.row, box.column, 1, box.columns},
           {{" " + Upper(state) + " ", bad ? Ink::kBadBadge : Ink::kBadge, 0},
            {paused ? "PAUSED" : "", Ink::kWarn, 0},
            {fmt::format("t {} s", Fixed(At(s, "time_s"), 2)), Ink::kBold, 1},
            {Speed(s), Ink::kPlain, 2},
            {Microseconds(At(s, "tick_p99_s")), Ink::kPlain, 3},
            {fmt::format("{} in {}", Plain(At(s, "object")), Plain(At(s, "hand"))), Ink::kDim, 5},
            {"regrasp " + Plain(At(s, "version")), Ink::kDim, 4}});
  if (box.rows < 2) return;
  const Json& noise = At(s, "noise");
  const Json& recording = At(s, "recording");
  const std::string rec = Recording(recording);
  PutItems(screen, {box.row + 1, box.column, 1, box.columns},
           {{" " + JobText(At(s, "job")), Ink::kPlain, 0},
            {"noise " + Plain(noise.is_object() ? At(noise, "preset") : noise), Ink::kPlain, 1},
            {"seed " + Plain(At(s, "seed")), Ink::kPlain, 2},
            {rec, rec == "rec off" ? Ink::kDim : Ink::kBad, 3},
            {CountText(Plain(At(s, "clients")), "client"), Ink::kDim, 4}});
}

void DrawObject(Screen* screen, const Box& box, const DashboardModel& model) {
  const Json& object = At(model.contacts(), "object");
  const Json& gait = At(model.status(), "gait");
  const Json& job = At(model.status(), "job");
  const bool turning = At(gait, "active") == true;
  std::string target, achieved;
  if (turning) {
    target = fmt::format("target {}°", Fixed(At(gait, "reference_angle_rad"), 1, kDegrees));
    achieved = fmt::format("reached {}°", Fixed(At(gait, "achieved_angle_rad"), 1, kDegrees));
  } else if (At(job, "angle_rad").is_number()) {
    achieved = fmt::format("turned {}°", Fixed(At(job, "angle_rad"), 1, kDegrees));
  } else {
    achieved = "not turning";
  }
  std::string error;
  const bool held = At(model.status(), "holds_alone") == true;
  const Json &is = At(object, "p_WO_m"), &wanted = At(object, "p_WO_reference_m");
  double distance = 0;
  if (held && is.is_array() && wanted.is_array() && is.size() == 3 && wanted.size() == 3) {
    for (std::size_t i = 0; i < 3; ++i) distance += std::pow(Number(is[i]) - Number(wanted[i]), 2);
    distance = std::sqrt(distance);
    error = fmt::format("off by {:.2f} mm", 1e3 * distance);
  }
  std::string slip = "slip none";
  if (model.slips() > 0)
    slip = fmt::format("slip {}×, last at {:.1f} s", model.slips(), model.last_slip_s());
  PutItems(
      screen, Labelled(screen, box, " object"),
      {{target, Ink::kPlain, 1},
       {achieved, turning ? Ink::kBold : Ink::kPlain, 0},
       {turning ? fmt::format("{} regrasps", Plain(At(gait, "regrasps"))) : "", Ink::kPlain, 4},
       {error, distance > 2e-3 ? Ink::kWarn : Ink::kPlain, 2},
       {slip, model.slips() > 0 ? Ink::kWarn : Ink::kDim, 3}});
}

void DrawFingers(Screen* screen, const Box& box, const DashboardModel& model) {
  const auto columns = FingerColumns(box.columns);
  const auto row_of = [&](int row, const std::vector<std::pair<std::string, Ink>>& cells) {
    int at = box.column;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].width == 0) continue;
      at += columns[i].gap;
      screen->Put(row, at, cells[i].first, cells[i].second, box.column + box.columns - at);
      at += columns[i].width;
    }
  };
  screen->Rule(box, "");
  std::vector<std::pair<std::string, Ink>> headings;
  for (const Column& column : columns) headings.emplace_back(column.heading, Ink::kTitle);
  row_of(box.row, headings);

  const auto fingers = Named(At(model.contacts(), "fingers"), "finger");
  const Json& quality = At(model.quality(), "fingers");
  double largest_force = 2, largest_phi = 1e-9;
  for (const auto& [name, f] : fingers) {
    largest_force = std::max(largest_force, Number(At(f, "force_n")));
    largest_phi = std::max(largest_phi, Number(At(At(quality, name.c_str()), "manipulability")));
  }
  const std::vector<char> letters = FingerLetters(model.Fingers());
  for (int i = 0; i < std::min(static_cast<int>(fingers.size()), box.rows - 1); ++i) {
    const auto& [name, f] = fingers[static_cast<std::size_t>(i)];
    const Json& q = At(quality, name.c_str());
    const std::string role = Plain(At(f, "role"));
    const bool touches = At(f, "in_contact") == true;
    const double force = Number(At(f, "force_n"));
    const Json &margin = At(q, "joint_limit_margin_rad"), &phi = At(q, "manipulability");
    const bool near = margin.is_number() && margin.get<double>() < kNearLimit;
    const Ink margin_ink = near ? Ink::kWarn : Ink::kPlain;
    const auto bar = [&](double fraction, std::size_t column) {
      return FineBar(fraction, columns[column].width);
    };
    row_of(box.row + 1 + i,
           {{fmt::format("{} {}", letters[static_cast<std::size_t>(i)], name), CurveInk(i)},
            {fmt::format("{} {}", RoleLetter(role), role), RoleInk(role)},
            {touches ? "● touch" : "○ none", touches ? Ink::kGood : Ink::kDim},
            {fmt::format("{:>4} N", Fixed(At(f, "force_n"), 2)), Ink::kPlain},
            {bar(force / largest_force, kForceBar), Ink::kGood},
            {fmt::format("{:>4}°{}", Fixed(margin, 1, kDegrees), near ? '!' : ' '), margin_ink},
            {bar(Number(margin) / kFarFromLimit, kLimitBar), margin_ink},
            {fmt::format("{:>6}", Fixed(phi, 3)), Ink::kPlain},
            {bar(Number(phi) / largest_phi, kPhiBar), CurveInk(i)}});
  }
}

void DrawExploration(Screen* screen, const Box& box, const DashboardModel& model) {
  const Json& now = At(model.quality(), "exploration");
  const Json& job = model.exploration_job();
  const bool active = now.is_object();
  const double from = Number(At(job, "phi_initial"));
  const Json& to = active ? At(now, "phi") : At(job, "phi_final");
  std::string gain;
  if (job.is_object() && from > 0 && Number(to) > 0)
    gain = fmt::format("φ {:.3f} → {} {:+.1f} %", from, Fixed(to, 3),
                       100 * (Number(to) - from) / from);
  const Ink gain_ink = Number(to) >= from ? Ink::kGood : Ink::kWarn;
  const Box rest = Labelled(screen, box, " explore");
  if (active) {
    const Json& gradient = At(now, "gradient_norm_1_m");  // null before the first cycle
    const double epsilon = Number(At(now, "gradient_threshold_1_m")),
                 norm = Number(gradient, std::numeric_limits<double>::infinity());
    PutItems(screen, rest,
             {{Plain(At(now, "finger")), Ink::kBold, 1},
              {"on " + Plain(At(now, "criterion")), Ink::kDim, 4},
              {"cycle " + Plain(At(now, "cycle")), Ink::kPlain, 3},
              {fmt::format("gradient {} {} ε {:.1f}", Fixed(gradient, 1),
                           norm > epsilon ? ">" : "<", epsilon),
               norm > epsilon ? Ink::kPlain : Ink::kGood, 2},
              {gain, gain_ink, 0}});
  } else if (job.is_object()) {
    const std::string end =
        At(job, "reason").is_string() ? Plain(At(job, "reason")) : Plain(At(job, "state"));
    PutItems(screen, rest,
             {{"last: " + Plain(At(job, "finger")), Ink::kPlain, 1},
              {"ended by " + end, Ink::kDim, 2},
              {"cycle " + Plain(At(job, "cycles")), Ink::kDim, 3},
              {gain, gain_ink, 0}});
  } else {
    PutItems(screen, rest, {{"no finger has explored yet", Ink::kDim, 0}});
  }
}

void DrawEvents(Screen* screen, const Box& box, const DashboardModel& model) {
  screen->Rule(box, "Events");
  const auto& events = model.events();
  const auto shown = std::min(events.size(), static_cast<std::size_t>(std::max(box.rows - 1, 0)));
  for (std::size_t i = 0; i < shown; ++i) {
    const Json& event = events[events.size() - shown + i];
    const int row = box.row + 1 + static_cast<int>(i);
    const std::string kind = Plain(At(event, "kind"));
    const bool bad = kind == "dropped" || kind == "fault" || kind == "refused";
    const bool warn = kind == "contact_lost" || kind == "slip";
    const int column =
        screen->Put(row, box.column, fmt::format("{:>9} s  ", Fixed(At(event, "t_s"), 2)),
                    Ink::kDim, box.columns);
    screen->Put(row, column, At(event, "text").is_string() ? Plain(At(event, "text")) : kind,
                bad    ? Ink::kBad
                : warn ? Ink::kWarn
                       : Ink::kPlain,
                box.column + box.columns - column);
  }
}

}  // namespace regrasp::cli
