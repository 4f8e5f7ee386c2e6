#include "core/journal/checked_json.h"

#include <string>

#include "core/common/nesting_depth.h"
#include "core/files/names.h"
#include "core/journal/journal.h"

namespace regrasp {

nlohmann::ordered_json ParseFileJson(std::string_view text) {
  if (const auto nul = text.find('\0'); nul != std::string_view::npos)
    throw JournalError("a NUL byte at position " + std::to_string(nul));
  if (NestingDepth(text) > kMaxFileDepth)
    throw JournalError("nested more than " + std::to_string(kMaxFileDepth) + " levels deep");
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    throw JournalError("not JSON: " + ShownText(e.what()));  // which quotes the file
  }
}

}  // namespace regrasp
