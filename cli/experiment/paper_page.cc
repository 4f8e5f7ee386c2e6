#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/experiment/paper.h"
#include "cli/experiment/paper_claims.h"
#include "cli/experiment/paper_deviations.h"
#include "cli/experiment/paper_tables.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr std::int64_t kFirstFreshSeed = 20000;

}  // namespace

std::string ReproductionPage(const PaperResults& r) {
  const Json &exploration = r.summaries.at("exploration"), &sweep = r.summaries.at("sweep");
  const Json& displaced = r.summaries.at("displaced");
  const Json& plan = exploration.at("experiment");
  const std::vector<std::string> fingers = plan.at("fingers");
  const std::string every = fingers.size() > 1 ? "all" : fingers.front();
  const PaperClaims claims = CompareClaims(r);
  const auto picture = [&](const std::string& file, const std::string& caption) {
    return fmt::format("![{}]({}/{})\n\n*{}.*\n\n", caption, r.data, file, caption);
  };
  const auto document = [&](const char* text, const char* file) {
    return r.among_documents ? fmt::format("[{}]({})", text, file)
                             : fmt::format("{} (docs/{} of the source)", text, file);
  };
  std::string text = fmt::format(
      "# Reproduction report\n\n"
      "Q. Li, R. Haschke, B. Bolder, H. Ritter, *Grasp Point Optimization for Unknown Object "
      "Manipulation in Hand Task*, claim by claim.\n\n"
      "Measured on {} with regrasp {}, build {}, by `{}`, which wrote this page. Seeds {} to {}{}; "
      "each varies the noise and the start. Intervals are Wilson's, 95 %. "
      "A "
      "trial that was refused, dropped or not grasped is no success. *Noise-free* is from the "
      "simulator, which the controller never sees. What a trial and a column is: {}; where each "
      "line of the paper is in the source: {}.\n\n"
      "## Claims\n{}\n"
      "Verdict: *yes*, the claim holds in every trial; *partly*, in at least {:.0f} %; *no*, in "
      "fewer. In all: {}.\n\n",
      r.date, Plain(plan.at("version")), Plain(plan.at("build")), r.command,
      plan.at("first_seed").get<std::int64_t>(),
      plan.at("first_seed").get<std::int64_t>() + plan.at("seeds").get<std::int64_t>() - 1,
      plan.at("first_seed").get<std::int64_t>() >= kFirstFreshSeed ? " were never used while tuning"
                                                                   : "",
      document("experiments", "experiments.md"), document("paper map", "paper_map.md"),
      claims.table, 100 * kPartlyShownFrom, claims.count);
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
  text += "The best within reach is that of the rays of the " + document("map", "experiments.md") +
          " of each start: a share above "
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
  text += "## Deviations\nEvery one with its place in the source: " +
          document("paper map", "paper_map.md") + ".\n";
  return text + PaperDeviations(r.parameters);
}

}  // namespace regrasp::cli
