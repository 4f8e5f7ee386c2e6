#pragma once

/// Prose for a terminal.

#include <cstddef>
#include <string>

namespace regrasp::cli {

/// `text` broken at blanks into lines of at most 80 columns, the second and later ones indented.
std::string Wrap(const std::string& text, std::size_t indent);

}  // namespace regrasp::cli
