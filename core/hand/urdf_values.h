#pragma once

/// Checks of the attributes of a URDF element. Each adds a problem that names element, attribute,
/// value and what is allowed, and then gives a harmless value. What is right is written back in the
/// form that every reader of the format takes: numbers with one space between. Used only by the
/// loaders.

#include <tinyxml2.h>

#include <optional>
#include <string>

#include "core/common/frames.h"
#include "core/hand/problems.h"

namespace regrasp {

inline constexpr double kMaxModelSize = 10;  ///< [m]; anything larger is a unit mistake

/// `text` shown in a message: quoted, cut to 60 characters, without control characters.
std::string Quoted(const std::string& text);
/// The same of a path, of which the last 80 characters are kept.
std::string QuotedPath(const std::string& path);

class UrdfValues {
 public:
  using Element = tinyxml2::XMLElement;

  /// `element`: what the message names, e.g. `link "a1"`.
  UrdfValues(std::string element, Problems* problems)
      : element_(std::move(element)), problems_(problems) {}

  template <typename... Args>
  void Add(int line, fmt::format_string<Args...> format, Args&&... args) const {
    problems_->AddText(line, element_ + ": " + fmt::format(format, std::forward<Args>(args)...));
  }

  /// A finite number; `otherwise` where the attribute is missing, a problem where that is not
  /// given.
  double Number(Element* node, const char* attribute, std::optional<double> otherwise = {}) const;
  /// A number > 0.
  double Positive(Element* node, const char* attribute) const;
  /// Three finite numbers.
  Vector3d Vector(Element* node, const char* attribute,
                  std::optional<Vector3d> otherwise = {}) const;
  /// The numbers of <origin xyz rpy> below `node`, if there is one.
  void Origin(Element* node) const;

 private:
  bool Parse(Element* node, const char* attribute, const char* text, int count, double* out) const;

  std::string element_;
  Problems* problems_;
};

}  // namespace regrasp
