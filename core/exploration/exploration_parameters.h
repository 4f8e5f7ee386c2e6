#pragma once

namespace regrasp {

/// Algorithm 1's constants. lambda and sigma are the paper's; the others are ours (PHYSICS, measured).
struct ExplorationParameters {
  double sigma = 0.15;              ///< start gradient: standard deviation per axis (line 2, paper)
  double lambda = 0.9;              ///< sliding mean (line 8, paper)
};

}  // namespace regrasp
