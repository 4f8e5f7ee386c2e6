#include "daemon/output/output_file.h"

namespace regrasp {

std::uintmax_t WriteOutput(const std::filesystem::path& target, Draft::Existing existing,
                           const std::function<void(const std::string& draft)>& write) {
  Draft draft(target, existing);
  write(draft.path());
  const std::uintmax_t bytes = std::filesystem::file_size(draft.path());
  draft.Commit();
  return bytes;
}

}  // namespace regrasp
