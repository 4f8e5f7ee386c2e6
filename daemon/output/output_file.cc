#include "daemon/output/output_file.h"

#include <stdexcept>
#include <string>

namespace regrasp {

std::uintmax_t WriteOutput(const std::filesystem::path& target, Draft::Existing existing,
                           const std::function<void(const std::string& draft)>& write) {
  Draft draft(target, existing);
  try {
    write(draft.path());
  } catch (const std::runtime_error& e) {
    // The writer knows the draft's name; who reads this, the file's.
    std::string cause = e.what();
    if (const auto at = cause.find(draft.path()); at != std::string::npos)
      cause.replace(at, draft.path().size(), target.string());
    throw std::runtime_error(cause);
  }
  const std::uintmax_t bytes = std::filesystem::file_size(draft.path());
  draft.Commit();
  return bytes;
}

}  // namespace regrasp
