#include "daemon/output/files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/files/draft.h"
#include "core/files/names.h"
#include "core/files/read_file.h"
#include "daemon/wire/rpc.h"

namespace regrasp {
namespace {

/// Of a file that is read whole: a checkpoint.
constexpr std::uint64_t kMaxReadBytes = 256u << 20;

}  // namespace

std::string CheckedFileName(const std::string& name, std::string_view param,
                            const std::vector<std::string_view>& suffixes,
                            std::string_view example) {
  const auto refuse = [&](std::string message) {
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                std::move(message),
                                fmt::format("give a plain name such as {}", example),
                                std::string(param),
                                {suffixes.begin(), suffixes.end()}});
  };
  if (const std::string fault = FileNameFault(name); !fault.empty())
    refuse(fmt::format("{} '{}' is not a plain file name: it {}", param, Shown(name), fault));
  const std::string suffix = std::filesystem::path(name).extension().string();
  if (suffixes.size() > 0 && std::ranges::find(suffixes, suffix) == suffixes.end())
    refuse(fmt::format("{} '{}' does not end in {}", param, name, fmt::join(suffixes, ", ")));
  return name;
}

void ReplaceFile(const std::filesystem::path& target, std::string_view text) {
  WriteWhole(target, text, Draft::Existing::kReplace);
}

std::string ReadFile(const std::filesystem::path& path) {
  return ReadRegularFile(path, kMaxReadBytes);
}

std::string ReadHead(const std::filesystem::path& path, std::uint64_t bytes) {
  return ReadRegularFile(path, bytes, bytes);
}

std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& directory,
                                           const std::vector<std::string_view>& suffixes) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  if (!std::filesystem::exists(directory, error) && !error) return files;  // nothing was written
  std::filesystem::directory_iterator entries(directory, error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    const std::string suffix = entries->path().extension().string();
    std::error_code unknown;
    if (std::ranges::find(suffixes, suffix) != suffixes.end() &&
        FileNameFault(entries->path().filename().string()).empty() &&
        entries->is_regular_file(unknown))
      files.push_back(entries->path());
  }
  if (error)
    throw std::runtime_error(
        fmt::format("cannot read the directory {}: {}", directory.string(), error.message()));
  std::ranges::sort(files);
  return files;
}

std::filesystem::path FreeFile(const std::filesystem::path& directory, const std::string& name,
                               std::string_view suffix) {
  std::error_code ignored;
  std::filesystem::path file = directory / fmt::format("{}{}", name, suffix);
  for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(file, ignored)); ++i)
    file = directory / fmt::format("{}-{}{}", name, i, suffix);
  return file;
}

void RemoveOldest(const std::vector<std::filesystem::path>& files, std::size_t keep,
                  const std::function<void(const std::filesystem::path&)>& removed) {
  if (files.size() <= keep) return;
  std::vector<std::pair<std::filesystem::file_time_type, std::filesystem::path>> by_age;
  std::error_code ignored;
  for (const auto& file : files)
    by_age.emplace_back(std::filesystem::last_write_time(file, ignored), file);
  std::ranges::sort(by_age);
  for (std::size_t i = 0; i < files.size() - keep; ++i)
    if (std::filesystem::remove(by_age[i].second, ignored) && removed) removed(by_age[i].second);
}

}  // namespace regrasp
