#include "core/hand/urdf_values.h"

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

namespace regrasp {
namespace {

std::vector<std::string> Words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; words.size() < 8 && in >> word;) words.push_back(word);
  return words;
}

/// What may have been meant.
std::string Hint(const std::string& attribute, const std::vector<std::string>& words,
                 const std::string& text, int count) {
  if (text.find("${") != std::string::npos || text.find("$(") != std::string::npos)
    return "; run xacro over the file first";
  if (text.find(',') != std::string::npos) return "; decimals take a point, and spaces separate";
  if (attribute == "scale" && words.size() == 1)
    return fmt::format("; try scale=\"{0} {0} {0}\"", words[0]);
  return count == 1 && words.size() > 1 ? "; one number" : "";
}

std::string WithoutControls(const std::string& text) {
  std::string shown;
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) shown += c;
  return shown;
}

/// A byte of UTF-8 that is not a character's first.
bool IsWithinCharacter(char c) { return (c & 0xC0) == 0x80; }

}  // namespace

std::string Quoted(const std::string& text) {
  std::string shown = WithoutControls(text);
  constexpr std::size_t kMost = 60;
  if (shown.size() > kMost) {
    std::size_t end = kMost;
    while (end > 0 && IsWithinCharacter(shown[end])) --end;
    shown = shown.substr(0, end) + "...";
  }
  return "\"" + shown + "\"";
}

std::string QuotedPath(const std::string& path) {
  std::string shown = WithoutControls(path);
  constexpr std::size_t kMost = 80;
  if (shown.size() > kMost) {
    std::size_t begin = shown.size() - kMost;
    while (begin < shown.size() && IsWithinCharacter(shown[begin])) ++begin;
    shown = "..." + shown.substr(begin);
  }
  return "\"" + shown + "\"";
}

bool UrdfValues::Parse(Element* node, const char* attribute, const char* text, int count,
                       double* out) const {
  std::vector<std::string> words = Words(text);
  bool good = static_cast<int>(words.size()) == count;
  for (int i = 0; good && i < count; ++i) {
    std::string& word = words[static_cast<std::size_t>(i)];
    if (word.starts_with("+")) word.erase(0, 1);
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), out[i]);
    good = error == std::errc() && rest == word.data() + word.size() && std::isfinite(out[i]);
  }
  if (good)
    node->SetAttribute(attribute, fmt::format("{}", fmt::join(words, " ")).c_str());
  else
    Add(node->GetLineNum(), "<{}> {} = {}; must be {}{}", node->Name(), attribute, Quoted(text),
        count == 1 ? "a finite number" : fmt::format("{} finite numbers", count),
        Hint(attribute, words, text, count));
  return good;
}

double UrdfValues::Number(Element* node, const char* attribute,
                          std::optional<double> otherwise) const {
  const char* text = node->Attribute(attribute);
  double value = otherwise.value_or(0);
  if (text != nullptr) {
    if (!Parse(node, attribute, text, 1, &value)) return otherwise.value_or(0);
  } else if (!otherwise) {
    Add(node->GetLineNum(), "<{}> {} is missing", node->Name(), attribute);
  }
  return value;
}

double UrdfValues::Positive(Element* node, const char* attribute) const {
  const char* text = node->Attribute(attribute);
  double value = 1;
  if (text == nullptr) {
    Add(node->GetLineNum(), "<{}> {} is missing", node->Name(), attribute);
  } else if (Parse(node, attribute, text, 1, &value) && !(value > 0)) {
    Add(node->GetLineNum(), "<{}> {} = {:.6g}; must be > 0", node->Name(), attribute, value);
    value = 1;
  }
  return value;
}

Vector3d UrdfValues::Vector(Element* node, const char* attribute,
                            std::optional<Vector3d> otherwise) const {
  const char* text = node->Attribute(attribute);
  Vector3d value = otherwise.value_or(Vector3d::Zero());
  if (text != nullptr) {
    Vector3d read;
    if (Parse(node, attribute, text, 3, read.data())) value = read;
  } else if (!otherwise) {
    Add(node->GetLineNum(), "<{}> {} is missing", node->Name(), attribute);
  }
  return value;
}

void UrdfValues::Origin(Element* node) const {
  Element* origin = node->FirstChildElement("origin");
  if (origin == nullptr) return;
  if (origin->Attribute("quat_xyzw") != nullptr)
    Add(origin->GetLineNum(), "<{}> <origin> quat_xyzw is not of URDF 1.0; must be rpy [rad]",
        node->Name());
  const Vector3d p = Vector(origin, "xyz", Vector3d::Zero());
  constexpr double kMostTurn = 6.3;  // a whole turn; more is meant in degrees [rad]
  for (const double angle : Vector(origin, "rpy", Vector3d::Zero()))
    if (std::abs(angle) > kMostTurn)
      Add(origin->GetLineNum(), "<{}> <origin> rpy = {:.6g}; allowed {:g} .. {:g} rad",
          node->Name(), angle, -kMostTurn, kMostTurn);
  for (const double c : p)
    if (std::abs(c) > kMaxModelSize)
      Add(origin->GetLineNum(), "<{}> <origin> xyz = {:.6g}; allowed {:g} .. {:g} m", node->Name(),
          c, -kMaxModelSize, kMaxModelSize);
}

}  // namespace regrasp
