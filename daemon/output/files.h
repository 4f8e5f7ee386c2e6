#pragma once

/// Files in the output directory, named by clients.

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace regrasp {

/// A plain file name with one of the suffixes (any, when the list is empty): throws RpcException
/// otherwise (rule 9). `example` is what the hint shows.
std::string CheckedFileName(const std::string& name, std::string_view param,
                            std::initializer_list<std::string_view> suffixes,
                            std::string_view example);

/// Writes beside the target and renames: a reader sees the old file or the new one. Throws
/// std::runtime_error with path and cause.
void ReplaceFile(const std::filesystem::path& target, std::string_view text);
/// The whole file. Throws std::runtime_error with path and cause.
std::string ReadFile(const std::filesystem::path& path);

}  // namespace regrasp
