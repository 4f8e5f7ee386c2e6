#pragma once

/// The paper's claims beside what was measured, each with the command that measures it.

#include <string>

#include "cli/experiment/paper.h"

namespace regrasp::cli {

/// A share of the trials from which a claim is called partly shown.
inline constexpr double kPartlyShownFrom = 0.9;

struct PaperClaims {
  std::string table;  ///< in Markdown, and the commands below it
  std::string count;  ///< "12 yes, 2 partly, 1 no"
};
/// Throws where a summary or a figure that a claim needs is not there.
PaperClaims CompareClaims(const PaperResults& results);

}  // namespace regrasp::cli
