#pragma once

/// What we do otherwise than the paper, or where it leaves the choice open.

#include <string>

#include "cli/client/client.h"

namespace regrasp::cli {

/// A table in Markdown, with the values of `parameters` (name: value). Throws CliError(kFailed) for
/// one that is not there.
std::string PaperDeviations(const Json& parameters);

}  // namespace regrasp::cli
