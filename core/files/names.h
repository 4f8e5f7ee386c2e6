#pragma once

/// Names that come from outside: of files, of models and their parts, of topics.

#include <string>
#include <string_view>

#include "core/common/reason.h"

namespace regrasp {

/// What is wrong with a name, or "": empty, longer than kMaxNameBytes, not UTF-8, control
/// characters or characters that change the direction of text.
std::string NameFault(std::string_view name);

/// The same for a name that becomes a file's: also no '/', and neither '.' nor '-' first.
std::string FileNameFault(std::string_view name);

/// The name as ShownText shows it, at most 64 bytes of it.
std::string Shown(std::string_view name);

/// A line of text as it may be shown to people: control characters, characters that change the
/// direction of text and what is no UTF-8 as "\x1b".
std::string ShownText(std::string_view text);

/// The same for several lines.
std::string ShownLines(std::string_view text);

/// True when the text is UTF-8 (of the shortest form, without surrogates).
bool IsUtf8(std::string_view text);

}  // namespace regrasp
