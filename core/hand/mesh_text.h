#pragma once

/// Mesh files in words, as other programs write them and assimp does not read them.

#include <string>
#include <string_view>

namespace regrasp {

/// Some editors write it before the text: U+FEFF in UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// ASCII letters only.
std::string InLowerCase(std::string text);

/// What assimp shall read instead of the file, or "": it takes a byte order mark for the first word
/// and knows an STL file in words by small letters only. `suffix`: of the file, in lower case.
std::string TextForAssimp(const std::string& file, const std::string& suffix);

}  // namespace regrasp
