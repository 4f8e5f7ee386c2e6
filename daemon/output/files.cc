#include "daemon/output/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "daemon/wire/rpc.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxFileName = 128;

[[noreturn]] void Fail(const char* what, const std::filesystem::path& path) {
  throw std::runtime_error(fmt::format("cannot {} {}: {}", what, path.string(),
                                       errno ? std::strerror(errno) : "unknown cause"));
}

}  // namespace

std::string CheckedFileName(const std::string& name, std::string_view param,
                            std::initializer_list<std::string_view> suffixes,
                            std::string_view example) {
  const auto refuse = [&](std::string message) {
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                std::move(message),
                                fmt::format("give a plain name such as {}", example),
                                std::string(param),
                                {suffixes.begin(), suffixes.end()}});
  };
  if (name.empty() || name.size() > kMaxFileName)
    refuse(fmt::format("file name of {} bytes; allowed are 1 to {}", name.size(), kMaxFileName));
  const bool control =
      std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  if (control || name.find('/') != std::string::npos || name.front() == '.')
    refuse(fmt::format("{} is not a plain file name", param));
  const std::string suffix = std::filesystem::path(name).extension().string();
  if (suffixes.size() > 0 && std::ranges::find(suffixes, suffix) == suffixes.end())
    refuse(fmt::format("{} '{}' does not end in {}", param, name, fmt::join(suffixes, ", ")));
  return name;
}

void ReplaceFile(const std::filesystem::path& target, std::string_view text) {
  std::filesystem::create_directories(target.parent_path());
  const std::filesystem::path draft = target.parent_path() / ".draft";
  std::filesystem::remove(draft);
  errno = 0;
  std::ofstream out(draft, std::ios::binary);
  out << text;
  out.close();
  if (!out) Fail("write", target);
  std::filesystem::rename(draft, target);
}

std::string ReadFile(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) Fail("read", path);
  return text;
}

}  // namespace regrasp
