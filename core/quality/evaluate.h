#pragma once

/// All quality measures of one grasp, for `regrasp evaluate FILE` and for low-rate display.

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/quality/grasp.h"
#include "core/quality/measures.h"

namespace regrasp {

/// A grasp to be judged. Names in messages are those of the file format (evaluate_json.h).
struct EvaluateInput {
  std::vector<GraspContact>
      contacts;  ///< positions within +-10 m, |normal| = 1 +- 1e-3, mu 0 ... 10, torsion 0 ... 10 m
  double torque_scale = 0.0;  ///< torques are divided by it [m], 1e-4 ... 10
  int cone_edges = 8;         ///< of the friction pyramid of epsilon and volume, 3 ... 1024
  /// Force of gravity on the object [N], within +-1e6; without it there is no load margin.
  std::optional<Vector3d> weight;
  double max_force = std::numeric_limits<double>::infinity();  ///< cap on normal forces [N], > 0
};

/// What `evaluate` answers; written out by evaluate_json.h.
struct EvaluateOutput {
  /// Every row of the table of measures; of hard fingers where a measure knows no others. None for
  /// one that only a request may ask for, of more than kMaxHullWrenches edges together: the facets
  /// of a whole six-dimensional hull grow with their cube.
  std::array<std::optional<double>, kNumMeasures> values{};
  bool force_closure = false;         ///< epsilon > 0
  std::optional<double> load_margin;  ///< rho [N], present with a weight; see LoadMargin()

  const std::optional<double>& of(Measure which) const {
    return values[static_cast<std::size_t>(which)];
  }
};

inline constexpr std::size_t kMaxEvaluateWrenches = 8192;  ///< contacts * cone_edges

/// Whether every normal points away from the centre: it was probably given outwards.
bool NormalsPointAway(const EvaluateInput& input);

/// What messages call the numbers of a grasp that comes from another file format.
struct EvaluateNames {
  struct Contact {
    std::string position, normal, mu, torsion;
  };
  std::vector<Contact> contacts;  ///< of the first contacts
  std::string torque_scale = "torque_scale_m";
};

/// Every number that is out of range: field, value and what is allowed.
std::vector<std::string> Faults(const EvaluateInput& input, const EvaluateNames& names = {});

/// Computes every measure. Slow (milliseconds),
/// allocates. Throws std::invalid_argument with the first of Faults().
EvaluateOutput Evaluate(const EvaluateInput& input);

}  // namespace regrasp
