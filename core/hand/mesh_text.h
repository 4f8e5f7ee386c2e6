#pragma once

/// Mesh files in words, as other programs write them and assimp does not read them.

#include <istream>
#include <string>
#include <string_view>

namespace regrasp {

/// Some editors write it before the text: U+FEFF in UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// ASCII letters only.
std::string InLowerCase(std::string text);

/// Reads past a byte order mark.
bool SkipByteOrderMark(std::istream* in);

/// Whether STL text begins here, behind white space, which is read past: with "solid", whatever its
/// letters. That word follows.
bool SkipToSolid(std::istream* in);

/// What assimp shall read instead of the file, or "": it takes a byte order mark for the first word
/// and knows an STL file in words by small letters at its beginning only. `suffix`: of the file, in
/// lower case.
std::string TextForAssimp(const std::string& file, const std::string& suffix);

}  // namespace regrasp
