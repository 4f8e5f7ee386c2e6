#pragma once

/// The file format of `regrasp evaluate FILE`.

#include <string>

namespace regrasp {

/// From the text of a grasp file
///
///   {"contacts": [{"position_m": [x, y, z], "normal": [x, y, z], "mu": m, "torsional_mu": t},
///   ...],
///    "torque_scale_m": r, "cone_edges": n, "weight_n": [x, y, z], "max_force_n": f,
///    "normals": "inward"}
///
/// or from what `regrasp contacts --json` prints, as it is (normals outward there, as it says;
/// torque scale the mean distance of the contacts, as in `quality`), to the text (one line) of its
/// measures
///
///   {"min_singular_value": s, "epsilon": e, ... (every row of the table of measures),
///    "force_closure": b, "load_margin_n": rho, "load_margin_unbounded": u}
///
/// Normals point into the object unless "normals" is "outward"; with "warnings" where all point
/// away from the centre. torsional_mu [m] makes a soft finger (grasp.h). volume is null above
/// kMaxHullWrenches edges together. A normal whose length is within 0.001 of 1 is normalised,
/// others are refused. cone_edges (8 when absent), weight_n and max_force_n (none when absent) are
/// optional; the two load_margin fields are there only with weight_n. A margin that nothing bounds
/// (force closure without max_force_n) is null with load_margin_unbounded true: JSON has no
/// infinity.
///
/// Throws std::invalid_argument for anything that is not such a file: malformed JSON (with line and
/// column), deeper than 32 levels; and, all that there are of them (ProblemList::Text), duplicate
/// or unknown names (with the nearest known one), missing fields, wrong types, numbers out of range
/// or not finite, each with field, value and what is allowed.
std::string EvaluateJson(const std::string& text);

}  // namespace regrasp
