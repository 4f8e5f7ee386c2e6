#include "cli/experiment/paper_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "cli/experiment/paper_tables.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kForceTolerance = 0.02;  // of the weight
constexpr double kTrueRadius_m = 0.025;   // the paper's sphere of 5 cm
constexpr double kRadiusTolerance_m = 0.001;
constexpr double kClearDrop = 0.75;  // of stability in S_F against the mean

const char* Verdict(double share) {
  return share >= 1 ? "yes" : share >= kPartlyShownFrom ? "partly" : "no";
}

const char* Verdict(const Json& group, const char* count) {
  return Verdict(group.at("counts").at(count).at("share").get<double>());
}

/// The table of claims.
class Claims {
 public:
  explicit Claims(std::string command) : commands_({std::move(command)}) {}
  void Add(const std::string& claim, const std::string& measured, const std::string& verdict,
           const std::string& command = "") {
    ++verdicts_[verdict];
    text_ += fmt::format("| {} | {} | {} | {} |\n", claim, measured, Note(command), verdict);
  }
  /// "12 yes, 2 partly, 1 no"
  std::string Count() const {
    std::string text;
    for (const char* verdict : {"yes", "partly", "no"})
      if (const auto n = verdicts_.find(verdict); n != verdicts_.end())
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n->second, verdict);
    return text;
  }
  std::string Text() const {
    std::string notes;
    for (std::size_t i = 0; i < commands_.size(); ++i)
      notes += fmt::format("{}. `{}`\n", i + 1, commands_[i]);
    return "| the paper | measured here (95 % interval) | command | verdict "
           "|\n|---|---|---|---|\n" +
           text_ + "\nCommands:\n\n" + notes;
  }

 private:
  /// "(2)", for a command in the list below the table. Empty: the whole report.
  std::string Note(const std::string& command) {
    const std::string& made = command.empty() ? commands_.front() : command;
    const auto place = std::find(commands_.begin(), commands_.end(), made);
    const auto index = place - commands_.begin();
    if (place == commands_.end()) commands_.push_back(made);
    return fmt::format("({})", index + 1);
  }

  std::vector<std::string> commands_;
  std::string text_;
  std::map<std::string, int> verdicts_;
};

void AddFigure2(const Json& measured, Claims* claims) {
  const Json& f = At(measured, "figure2");
  if (!f.is_object()) return;
  claims->Add("Fig. 2: “both motions start from the same initial configuration”",
              fmt::format("state hash {} and {}", Plain(f.at("start_hash").at(0)),
                          Plain(f.at("start_hash").at(1))),
              f["start_hash"][0] == f["start_hash"][1] ? "yes" : "no");
  const double first = f.at("first_stability").at(0);
  const double least = std::min(f.at("least_stability").at(0).get<double>(),
                                f.at("least_stability").at(1).get<double>());
  claims->Add("Fig. 2: “the grasp is stable …, although stability may decrease”",
              fmt::format("stability {:.3f} at the start, never below {:.3f}; threshold {:.2f}",
                          first, least, f.at("threshold").get<double>()),
              least >= f.at("threshold").get<double>() ? "yes" : "no");
  for (const char* criterion : {"manipulability", "combined"}) {
    const Json& record = f.at(criterion);
    if (!At(record, "phi_true_initial").is_number()) {
      claims->Add(fmt::format("Fig. 2: {} as the criterion", criterion), Plain(At(record, "error")),
                  "no");
      continue;
    }
    const double from = record.at("phi_true_initial"), to = record.at("phi_true_final");
    claims->Add(fmt::format("Fig. 2: {} as the criterion", criterion),
                fmt::format("noise-free objective {:.3f} to {:.3f} ({:+.1f} %)", from, to,
                            100 * (to / from - 1)),
                to > from ? "yes" : "no");
  }
  const int runs = measured.at("repeats").at("runs"), rose = measured["repeats"].at("rose");
  claims->Add(
      "“Repeating the exploratory motion 50 times using different initial gradient "
      "directions, always leads to a successful maximization”",
      fmt::format("ring finger, one start, noise-free φ rose: {}, dropped {}", Share(rose, runs),
                  measured["repeats"].at("dropped").get<int>()),
      runs > 0 ? Verdict(static_cast<double>(rose) / runs) : "no");
}

/// The little finger: what it gains in manipulability costs stability.
void AddTradeoff(const Json& measured, Claims* claims) {
  if (const Json& t = At(measured, "tradeoff"); t.is_object()) {
    const double start = t.at("first_stability");
    const double alone = t.at("last_stability").at(0), sum = t.at("last_stability").at(1);
    claims->Add("Fig. 2: “stability may decrease”: the little finger",
                fmt::format("stability {:.3f} at the start; {:.3f} at the end with manipulability "
                            "as the criterion, {:.3f} with the linear sum",
                            start, alone, sum),
                t.at("shown") == true ? "yes" : "no");
  }
}

void AddGait(const Json& measured, Claims* claims) {
  const Json& gait = measured.at("rotate").at("exploring").at("gait");
  const Json& record = measured["rotate"]["exploring"];
  std::string pattern;
  bool right = true;
  for (const auto& [finger, samples] : gait.at("objective").items()) {
    const char* wanted = finger == "first" ? "stability" : "manipulability";
    right = right && samples.size() == 1 && samples.contains(wanted);
    for (const auto& [objective, n] : samples.items())
      pattern += fmt::format("{}{}: {}", pattern.empty() ? "" : ", ", finger, objective);
  }
  claims->Add(
      "Fig. 3b: “always maximizes the manipulability of the exploring finger – except in "
      "state S_F, where the grasp stability is chosen”",
      pattern, right && gait.at("objective").size() > 1 ? "yes" : "no");
  claims->Add(
      "“multiply readjusting the grasp configuration with all fingers in turn”",
      fmt::format("{} fingers explored, {} regrasps in {} turn", gait.at("objective").size(),
                  Plain(At(record, "regrasps")), Fixed(At(record, "turns"), 1)),
      gait.at("objective").size() == measured.at("hold").at("fingers") ? "yes" : "no");
  const Json &all = gait.at("stability_mean"), &without = gait.at("stability_without_next_mean");
  if (all.is_number() && without.is_number())
    claims->Add(
        "“in this state, the grasp stability drops to a low value”, the thumb being excluded",
        fmt::format("stability without the thumb in S_F {:.2f}, of the grasp {:.2f} (means)",
                    without.get<double>(), all.get<double>()),
        without.get<double>() < kClearDrop * all.get<double>() ? "yes" : "no");
  if (const Json& sphere = gait.at("sphere"); sphere.is_object()) {
    const double radius = sphere.at("radius_m");
    claims->Add(
        "Fig. 3a: the contact points reveal “valuable shape information”",
        fmt::format("sphere through {} points: radius {:.1f} mm (true {:.1f}), rms {:.2f} mm",
                    Plain(gait.at("contact_points")), radius * 1e3, kTrueRadius_m * 1e3,
                    sphere.at("rms_error_m").get<double>() * 1e3),
        std::abs(radius - kTrueRadius_m) < kRadiusTolerance_m ? "yes" : "no");
  }
}

void AddRotation(const Json& summary, const std::string& claim, Claims* claims) {
  const Json& group = summary.at("groups").at(0);
  const Json& quantiles = group.at("quantiles");
  std::string measured = fmt::format(
      "{} turn completed {}, dropped {}; median {} °/min; object within {} mm, axis within {}°",
      summary.at("experiment").at("turns").get<double>(), Share(group, "completed"),
      Plain(group.at("counts").at("dropped").at("k")),
      Fixed(At(quantiles.at("rate_deg_min"), "median"), 0),
      Fixed(At(quantiles.at("max_position_error_m"), "max"), 1, 1e3),
      Fixed(At(quantiles.at("max_tilt_rad"), "max"), 1, kDegrees));
  claims->Add(claim, measured, Verdict(group, "completed"), CommandOf(summary));
}

}  // namespace

PaperClaims CompareClaims(const PaperResults& r) {
  const Json &exploration = r.summaries.at("exploration"), &sweep = r.summaries.at("sweep");
  const Json& displaced = r.summaries.at("displaced");
  const Json& plan = exploration.at("experiment");
  const Json& hold = r.figures.at("hold");
  Claims claims(r.command);
  const double force = hold.at("force_n"), weight = hold.at("weight_n");
  claims.Add("Fig. 1: a 22-DoF Shadow Hand holds a sphere of 5 cm it knows nothing of",
             fmt::format("{} of {} fingers touch; forces sum to {:.3f} N, weight {:.3f} N",
                         Plain(hold.at("touching")), Plain(hold.at("fingers")), force, weight),
             hold.at("touching") == hold.at("fingers") &&
                     std::abs(force - weight) < kForceTolerance * weight
                 ? "yes"
                 : "no");
  const std::vector<std::string> fingers = plan.at("fingers");
  const std::string every = fingers.size() > 1 ? "all" : fingers.front();
  const auto of = [&](const Json& summary, const char* estimator) {
    return GroupOf(summary, {{"estimator", estimator}, {"finger", every}});
  };
  const Json all = of(exploration, "least_squares"), printed = of(exploration, "secant");
  const Json away = of(displaced, "least_squares"), away_printed = of(displaced, "secant");
  claims.Add("Alg. 1 “estimates and follows the gradient of a smooth objective function”",
             "noise-free φ rose: " + Share(all, "rose"), Verdict(all, "rose"),
             CommandOf(exploration));
  claims.Add("… with the gradient rule as printed", "noise-free φ rose: " + Share(printed, "rose"),
             Verdict(printed, "rose"), CommandOf(exploration));
  claims.Add("… from starts displaced by 3 mm, where there is more to gain",
             fmt::format("noise-free φ rose: {}; rule as printed: {}", Share(away, "rose"),
                         Share(away_printed, "rose")),
             Verdict(away, "rose"), CommandOf(displaced));
  claims.Add("it “searches for locally optimal contact points”",
             "noise-free φ within 5 % of the best within reach: " + Share(all, "near_best"),
             Verdict(all, "near_best"), CommandOf(exploration));
  AddFigure2(r.figures, &claims);
  AddTradeoff(r.figures, &claims);
  AddRotation(r.summaries.at("exploring"),
              "“continuous rotation of the object following the finger gait”, fingers explore",
              &claims);
  AddRotation(r.summaries.at("returning"), "the same, fingers return to their first contact (ours)",
              &claims);
  AddRotation(r.summaries.at("planned"),
              "the same, landings planned on the surface as felt (ours, the default)", &claims);
  AddGait(r.figures, &claims);
  const auto noisy = [&](const char* noise) {
    return GroupOf(sweep, {{"noise", noise}, {"estimator", "least_squares"}, {"finger", every}});
  };
  claims.Add("feasible with “artificial white noise … to model noisy real-world sensors”",
             fmt::format("φ rose at noise off {}, paper {}, coarse {}", Share(noisy("off"), "rose"),
                         Share(noisy("paper"), "rose"), Share(noisy("coarse"), "rose")),
             Verdict(noisy("paper"), "rose"), CommandOf(sweep));
  return {claims.Text(), claims.Count()};
}

}  // namespace regrasp::cli
