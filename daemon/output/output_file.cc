#include "daemon/output/output_file.h"

namespace regrasp {

std::uintmax_t WriteOutput(const std::filesystem::path& target,
                           const std::function<void(const std::string& draft)>& write) {
  std::filesystem::create_directories(target.parent_path());
  const std::filesystem::path draft =
      target.parent_path() / (".draft" + target.extension().string());
  std::filesystem::remove(draft);
  write(draft.string());
  const std::uintmax_t bytes = std::filesystem::file_size(draft);
  std::filesystem::rename(draft, target);
  return bytes;
}

}  // namespace regrasp
