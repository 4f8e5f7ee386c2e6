#pragma once

/// Files in the output directory, named by clients.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace regrasp {

/// A plain file name with one of the suffixes (any, when the list is empty): throws RpcException
/// otherwise (docs/protocol.md: Files). `example` is what the hint shows.
std::string CheckedFileName(const std::string& name, std::string_view param,
                            const std::vector<std::string_view>& suffixes,
                            std::string_view example);

/// Writes beside the target and renames: a reader sees the old file or the new one. Throws
/// std::runtime_error with path and cause.
void ReplaceFile(const std::filesystem::path& target, std::string_view text);
/// The whole regular file, or its beginning. Throws std::runtime_error with path and cause: a FIFO
/// or a device is not waited for.
std::string ReadFile(const std::filesystem::path& path);
std::string ReadHead(const std::filesystem::path& path, std::uint64_t bytes);

/// The regular files of a directory with one of the suffixes and a plain name, sorted by name; none
/// where the directory is missing. Throws std::runtime_error when it cannot be read.
std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& directory,
                                           const std::vector<std::string_view>& suffixes);
/// The first of NAME.suffix, NAME-2.suffix ... that is not there yet.
std::filesystem::path FreeFile(const std::filesystem::path& directory, const std::string& name,
                               std::string_view suffix);
/// Removes the oldest until `keep` are left; calls `removed` for each.
void RemoveOldest(const std::vector<std::filesystem::path>& files, std::size_t keep,
                  const std::function<void(const std::filesystem::path&)>& removed = {});

}  // namespace regrasp
