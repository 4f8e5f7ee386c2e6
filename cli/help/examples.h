#pragma once

/// What the help shows first. Every line is run by the tests (tests/end_to_end/test_documents.py).

#include <span>
#include <string_view>
#include <vector>

namespace regrasp::cli {

struct Example {
  std::string_view words;    ///< of the command it belongs to; "" for the overview
  std::string_view line;     ///< for a shell, as it is
  std::string_view meaning;  ///< what it does
};

/// The examples of one command, in the order in which they are shown.
std::vector<Example> ExamplesOf(std::string_view words);

}  // namespace regrasp::cli
