#include "core/hand/mesh_text.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

namespace regrasp {

std::string InLowerCase(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string TextForAssimp(const std::string& file, const std::string& suffix) {
  constexpr std::string_view kSolid = "SOLID";
  std::ifstream in(file, std::ios::binary);
  std::string begin(kSolid.size(), '\0');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const bool bom = begin.starts_with(kByteOrderMark),
             capitals = suffix == ".stl" && begin == kSolid;
  if (!bom && !capitals) return "";
  in.clear();
  in.seekg(bom ? kByteOrderMark.size() : 0);
  std::string text(std::istreambuf_iterator<char>(in), {});
  return suffix == ".stl" ? InLowerCase(text) : text;
}

}  // namespace regrasp
