#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>

#include "cli/experiment/paper.h"
#include "cli/experiment/paper_tables.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kForceTolerance = 0.02;  // of the weight
constexpr double kTrueRadius_m = 0.025;   // the paper's sphere of 5 cm
constexpr double kRadiusTolerance_m = 0.001;
constexpr double kFewestSteps =
    100;  // turns of so many parts are written as turns, else as an angle
constexpr std::int64_t kFirstFreshSeed = 20000;
constexpr double kMostly = 0.9;      // a share from which "always" is called partly shown
constexpr double kClearDrop = 0.75;  // of stability in S_F against the mean

/// What we do otherwise than the paper, or where it leaves the choice open. {NAME} is the value of
/// a parameter, {NAME*F} that value times F.
constexpr const char* kDeviations = R"(
| where | the paper | here, and why |
|---|---|---|
| line 2 | start gradient N(0, 0.15), no unit | two tangential components, times ∇max = {exploration.gradient_max} /m: 0.15 /m would vanish beside the gradients met |
| line 3 | stop at ‖P T⁻¹ ∇̃φ‖ ≤ ε | for {exploration.converged_updates} updates in a row, as one estimate may merely cross zero; what points into a wall is removed first. ε = {exploration.epsilon} /m and N_max = {exploration.max_cycles} cycles are ours |
| line 4 | every n cycles | also not before the contact has moved {exploration.min_displacement*1e3} mm: a secant over less is noise. n = {exploration.update_cycles} is ours |
| line 5 | Δc = P T (c′ − c) | the inverse of T: as printed it turns a displacement in r the wrong way |
| line 6 | component-wise secant | offered as `secant`; the default fits the gradient by least squares over the recent past, with a circular dither |
| line 7 | limit to ∇max | ∇max = {exploration.gradient_max} /m is ours |
| line 3, 11 | P, T at the contact | the contact is placed on the fingertip's known surface by its sensed normal: 2° of normal noise move it less than 1 mm of position noise |
| line 11 | a displacement η ∇̃φ | a velocity, held to {exploration.speed_min*1e3} … {exploration.speed_max*1e3} mm/s: slower, friction stops the finger; with least squares the dither keeps it moving, and the least speed falls with a gradient below ε. η = {exploration.eta} m²/s is ours |
| Alg. 1 | reference frame r | W, the fixed palm's frame |
| Alg. 1 | φ in no unit | manipulability sqrt(det J Jᵀ) in 1e-4 m³, so that φ is of order 1 |
| Alg. 1 | no bound | at most {exploration.max_excursion*1e3} mm from the start; joint limits, the other fingers and the end of the round fingertip are walls; with least squares a return to the best φ met and up to three tries |
| Sec. II | grasp stability, no formula | smallest singular value of the grasp matrix, torques over the mean contact distance; others can be chosen |
| Sec. II | a minimal threshold | {control.stability_threshold}, ours; back to manipulability 5 % above it |
| Fig. 2 | linear sum, no weights | φ + {exploration.stability_weight} σ_min |
| Sec. II | hybrid controller of earlier work | object wrench by PI on the sensed pose, friction-cone QP for contact forces, joint torques by Jᵀf, posture springs in the null space. A sliding finger: force along the normal ({exploration.normal_force} N, less where the load margin asks), velocity with friction feedforward across it |
| Sec. II | the object is in the hand | a stand-in holds it while the hand closes, and lets go before anything is measured |
| Sec. III | Vortex | ODE at 1 kHz |
| Sec. III | noise of a real sensor, no numbers | presets; `paper` is 1 mm, 2°, 0.05 N, joints 0.3°, object 1 mm and 1°; contact normals and joint angles are noisy, too |
| Sec. III | one start | each seed has its own start: joints σ {start.joint_sigma_rad*57.29578}°, object σ {start.object_sigma_m*1e3} mm |
| Fig. 1 | Shadow Hand model of [8] | 22 joints, links as capsules, one drive per joint |
| Sec. III | sphere of 5 cm | 80 g, friction 0.8 |
| Sec. III b | S_L, S_R, S_M, S_F, S_T | the same order; the opposing finger is found from the contact normals and is always last |
| Sec. III b | a fixed gait | a finger leaves only while the others keep a load margin of {gait.margin_min} N; contacts that let the thumb leave ({gait.margin_wanted} N) are sought first |
| Sec. III b | the free finger explores | for at most {gait.explore_s} s, within {gait.disc_radius*1e3} mm of its first contact, from the gradient with which its last exploration ended |
| Sec. III b | fingers slide to new contacts | they hop back to where they first touched, then slide while they explore. That is `gait.preset paper`; by default they do not explore, and come back to where the surface as felt says the grasp goes on best (`planned`) |
)";

/// kDeviations with the values of `parameters`. Throws CliError(kFailed) for one that is not there.
std::string Deviations(const Json& parameters) {
  std::string text;
  std::string_view rest = kDeviations;
  for (std::size_t open = rest.find('{'); open != rest.npos; open = rest.find('{')) {
    const std::size_t close = rest.find('}', open);
    const std::string field(rest.substr(open + 1, close - open - 1));
    const std::size_t times = field.find('*');
    const std::string name = field.substr(0, times);
    const Json& value = At(parameters, name.c_str());
    if (!value.is_number())
      throw CliError(kFailed, fmt::format("the daemon has no parameter {}", name));
    const double factor =
        times == field.npos ? 1 : ParseNumber(field.substr(times + 1), "a deviation's factor");
    text += rest.substr(0, open);
    text += fmt::format("{:.4g}", value.get<double>() * factor);
    rest.remove_prefix(close + 1);
  }
  return text + std::string(rest);
}

const char* Verdict(double share) {
  return share >= 1 ? "yes" : share >= kMostly ? "partly" : "no";
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

std::string ReproductionPage(const PaperResults& r) {
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

  const auto picture = [&](const std::string& file, const std::string& caption) {
    return fmt::format("![{}]({}/{})\n\n*{}.*\n\n", caption, r.data, file, caption);
  };
  std::string text = fmt::format(
      "# Reproduction report\n\n"
      "Q. Li, R. Haschke, B. Bolder, H. Ritter, *Grasp Point Optimization for Unknown Object "
      "Manipulation in Hand Task*, claim by claim.\n\n"
      "Measured on {} with regrasp {}, build {}, by `{}`, which wrote this page. Seeds {} to {}{}; "
      "each varies the noise and the start. Intervals are Wilson's, 95 %. "
      "A "
      "trial that was refused, dropped or not grasped is no success. *Noise-free* is from the "
      "simulator, which the controller never sees. What a trial and a column is: "
      "[experiments](experiments.md); where each line of the paper is in the source: [paper "
      "map](paper_map.md).\n\n"
      "## Claims\n{}\n"
      "Verdict: *yes*, the claim holds in every trial; *partly*, in at least {:.0f} %; *no*, in "
      "fewer. In all: {}.\n\n",
      r.date, Plain(plan.at("version")), Plain(plan.at("build")), r.command,
      plan.at("first_seed").get<std::int64_t>(),
      plan.at("first_seed").get<std::int64_t>() + plan.at("seeds").get<std::int64_t>() - 1,
      plan.at("first_seed").get<std::int64_t>() >= kFirstFreshSeed ? " were never used while tuning"
                                                                   : "",
      claims.Text(), 100 * kMostly, claims.Count());
  text += "## Figures\n";
  text +=
      picture("figure1.png", "Figure 1: the hand holds the sphere; arrows are true contact forces");
  text += picture("figure2.png", "Figure 2: the ring finger explores, two criteria, one start");
  if (r.figures.contains("tradeoff"))
    text += picture("figure2-little.png",
                    "Figure 2 of the little finger: what it gains in manipulability costs "
                    "stability");
  text +=
      picture("figure3a.png", "Figure 3a: contact points in the object's frame, fingers exploring");
  text += picture("figure3b.png", "Figure 3b: the gait, fingers exploring");
  text += "## Explorations\nNoise `paper`, criterion manipulability.\n\n" +
          ExplorationTable(exploration) + "\n";
  text += picture("exploration/summary.png", "Explorations of every finger");
  text +=
      "The best within reach is that of the rays of the [map](experiments.md) of each start: a "
      "share above "
      "100 % means that the exploration found its way to a place that no ray met.\n\n";
  text += "From starts whose fingertips are displaced by 3 mm along the surface:\n\n" +
          ExplorationTable(displaced) + "\n";
  text +=
      "## Success against noise\nNoise-free φ at the end within 5 % of the best within "
      "reach:\n\n" +
      SweepTable(sweep, "near_best") + "\nNoise-free φ rose:\n\n" + SweepTable(sweep, "rose") +
      "\nHow those that were not done ended, all fingers:\n\n" + OutcomeTable(sweep, every) + "\n";
  text += picture("sweep/summary.png", "Success against noise");
  if (std::any_of(r.parts.begin(), r.parts.end(),
                  [](const PaperPart& part) { return !part.title.empty(); }))
    text += fmt::format(
        "## Rotations beyond the paper\n"
        "{} turn about −z at noise `paper` where nothing else is said. *Stopped*: the gait gave up "
        "or "
        "was refused, the object still in the hand. *Slips*: regrasps broken off. *φ rose*: of the "
        "regrasps that explored by manipulability and began below 98 % of the finger's best in "
        "that "
        "rotation, in how many it was higher at the end.\n\n",
        r.summaries.at("returning").at("experiment").at("turns").get<double>());
  for (const PaperPart& part : r.parts) {
    if (part.title.empty()) continue;
    const Json& summary = r.summaries.at(part.name);
    text += fmt::format("### {}\n{}\n\n{}\n", part.title, part.text, RotationTable(summary));
    text += picture(part.name + "/summary.png", part.title);
    text += fmt::format("```\n{}\n```\n\n", CommandOf(summary));
  }
  text += "## Deviations\nEvery one with its place in the source: [paper map](paper_map.md).\n";
  return text + Deviations(r.parameters);
}

}  // namespace regrasp::cli
