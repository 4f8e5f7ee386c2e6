#include "core/hand/mesh_text.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

namespace regrasp {
namespace {

constexpr std::string_view kSolid = "solid";

}  // namespace

std::string InLowerCase(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool SkipByteOrderMark(std::istream* in) {
  const auto begin = in->tellg();
  std::string text(kByteOrderMark.size(), '\0');
  if (in->read(text.data(), static_cast<std::streamsize>(text.size())) && text == kByteOrderMark)
    return true;
  in->clear();
  in->seekg(begin);
  return false;
}

bool SkipToSolid(std::istream* in) {
  *in >> std::ws;
  in->clear();
  const auto begin = in->tellg();
  std::string word(kSolid.size(), '\0');
  const bool solid = in->read(word.data(), static_cast<std::streamsize>(word.size())) &&
                     InLowerCase(word) == kSolid;
  in->clear();
  in->seekg(begin);
  return solid;
}

std::string TextForAssimp(const std::string& file, const std::string& suffix) {
  std::ifstream in(file, std::ios::binary);
  const bool stl = suffix == ".stl", bom = SkipByteOrderMark(&in);
  if (stl) SkipToSolid(&in);
  const auto skipped = static_cast<std::size_t>(std::streamoff{in.tellg()});
  const bool blank = stl && skipped > (bom ? kByteOrderMark.size() : 0);
  std::string text(kSolid.size(), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (!bom && !blank && !(stl && text != kSolid)) return "";
  text.append(std::istreambuf_iterator<char>(in), {});
  return stl ? InLowerCase(text) : text;
}

}  // namespace regrasp
