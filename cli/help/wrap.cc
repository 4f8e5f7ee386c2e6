#include "cli/help/wrap.h"

#include <algorithm>

#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr std::size_t kWidth = 80;

}  // namespace

std::string Wrap(const std::string& text, std::size_t indent) {
  std::string result, line;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const auto used = static_cast<std::size_t>(DisplayWidth(line));
    if (!line.empty() && used + 1 + word.size() > kWidth) {
      result += line + "\n";
      line = std::string(indent, ' ') + word;
    } else {
      line += (begin == 0 ? "" : " ") + word;
    }
    begin = end + 1;
  }
  return result + line + "\n";
}

}  // namespace regrasp::cli
