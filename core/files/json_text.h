#pragma once

#include <string>

namespace regrasp {

/// JSON as text, in one line or indented: what is no UTF-8, as names of files may be, is replaced
/// instead of thrown. For any nlohmann::basic_json, so that no header of ours shows it.
template <typename Json>
std::string JsonText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace regrasp
