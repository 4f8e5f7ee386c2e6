#include "core/hand/urdf_values.h"

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

}  // namespace

std::string Shown(const std::string& text) {
  std::string shown;
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) shown += c;
  constexpr std::size_t kMost = 60;
  if (shown.size() > kMost) {
    std::size_t end = kMost;
    while (end > 0 && (shown[end] & 0xC0) == 0x80) --end;  // not within a UTF-8 character
    shown = shown.substr(0, end) + "...";
  }
  return "\"" + shown + "\"";
}

bool UrdfValues::Parse(const XmlNode& node, const char* attribute, const std::string& text,
                       int count, double* out) const {
  const std::vector<std::string> words = Words(text);
  bool good = static_cast<int>(words.size()) == count;
  for (int i = 0; good && i < count; ++i) {
    std::string_view word = words[static_cast<std::size_t>(i)];
    if (word.starts_with("+")) word.remove_prefix(1);
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), out[i]);
    good = error == std::errc() && rest == word.data() + word.size() && std::isfinite(out[i]);
  }
  if (!good)
    Add(node.line, "<{}> {} = {}; must be {}{}", node.name, attribute, Shown(text),
        count == 1 ? "a finite number" : fmt::format("{} finite numbers", count),
        Hint(attribute, words, text, count));
  return good;
}

double UrdfValues::Number(const XmlNode& node, const char* attribute,
                          std::optional<double> otherwise) const {
  const std::string* text = node.Find(attribute);
  double value = otherwise.value_or(0);
  if (text != nullptr) {
    if (!Parse(node, attribute, *text, 1, &value)) return otherwise.value_or(0);
  } else if (!otherwise) {
    Add(node.line, "<{}> {} is missing", node.name, attribute);
  }
  return value;
}

double UrdfValues::Positive(const XmlNode& node, const char* attribute) const {
  const std::string* text = node.Find(attribute);
  double value = 1;
  if (text == nullptr) {
    Add(node.line, "<{}> {} is missing", node.name, attribute);
  } else if (Parse(node, attribute, *text, 1, &value) && !(value > 0)) {
    Add(node.line, "<{}> {} = {:.6g}; must be > 0", node.name, attribute, value);
    value = 1;
  }
  return value;
}

Vector3d UrdfValues::Vector(const XmlNode& node, const char* attribute,
                            std::optional<Vector3d> otherwise) const {
  const std::string* text = node.Find(attribute);
  Vector3d value = otherwise.value_or(Vector3d::Zero());
  if (text != nullptr) {
    Vector3d read;
    if (Parse(node, attribute, *text, 3, read.data())) value = read;
  } else if (!otherwise) {
    Add(node.line, "<{}> {} is missing", node.name, attribute);
  }
  return value;
}

Isometry3d UrdfValues::Origin(const XmlNode& node) const {
  Isometry3d X = Isometry3d::Identity();
  const XmlNode* origin = node.Child("origin");
  if (origin == nullptr) return X;
  Vector3d p = Vector(*origin, "xyz", Vector3d::Zero());
  const Vector3d rpy = Vector(*origin, "rpy", Vector3d::Zero());
  for (const double c : p)
    if (std::abs(c) > kMaxModelSize) {
      Add(origin->line, "<{}> <origin> xyz = {:.6g}; allowed {:g} .. {:g} m", node.name, c,
          -kMaxModelSize, kMaxModelSize);
      p.setZero();
    }
  // The half angles, as every reader of the format forms the quaternion.
  const Vector3d h = rpy / 2;
  const Vector3d c(std::cos(h.x()), std::cos(h.y()), std::cos(h.z()));
  const Vector3d s(std::sin(h.x()), std::sin(h.y()), std::sin(h.z()));
  const Quaterniond q(
      c.x() * c.y() * c.z() + s.x() * s.y() * s.z(), s.x() * c.y() * c.z() - c.x() * s.y() * s.z(),
      c.x() * s.y() * c.z() + s.x() * c.y() * s.z(), c.x() * c.y() * s.z() - s.x() * s.y() * c.z());
  X.linear() = q.normalized().normalized().toRotationMatrix();
  X.translation() = p;
  return X;
}

}  // namespace regrasp
