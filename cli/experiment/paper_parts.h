#pragma once

/// The experiments of the reproduction report: what the paper shows, what goes beyond it, and what
/// becomes of it without one of its parts.

#include <string>
#include <vector>

#include "cli/experiment/plan.h"

namespace regrasp::cli {

/// One experiment of the report.
struct PaperPart {
  std::string name;   ///< its directory
  std::string title;  ///< heading of its section; empty: its results stand in another one
  std::string text;   ///< what it is for, a paragraph of the page
  Plan plan;
};

/// How much of everything.
struct PaperSize {
  std::int64_t seed = 0;
  std::int64_t seeds = 0;  ///< of the explorations; the other parts take a fifth of them
  std::string finger;      ///< of the explorations and the sweep; "all"
  int rays = 0;            ///< of the maps of phi
  double turns = 0;        ///< of a rotation
  std::string models_dir;
};

/// exploration, displaced, sweep, returning, exploring, axes, one-motion, noise, tilt, conditions,
/// long, ablations, in this order.
std::vector<PaperPart> PaperParts(const PaperSize& size);

}  // namespace regrasp::cli
