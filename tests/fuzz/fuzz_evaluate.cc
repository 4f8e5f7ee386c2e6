// A grasp file: refused in one line or a short list of lines, or measures that are numbers or null.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "core/quality/evaluate_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string answer = regrasp::EvaluateJson({reinterpret_cast<const char*>(data), size});
    const auto json = nlohmann::json::parse(answer);
    if (!json.at("force_closure").is_boolean() || !(json.at("epsilon") >= 0.0)) std::abort();
  } catch (const std::invalid_argument& e) {
    const std::string said = e.what();
    const bool list = said.find(" errors:\n  ") < 4;
    if (std::ranges::count(said, '\n') > (list ? 51 : 0)) std::abort();
  }
  return 0;
}
