#pragma once

/// Numbers, vectors and poses of URDF attributes. Each reader adds a problem that names element,
/// attribute, value and what is allowed, and then gives a harmless value. Used only by the loaders.

#include <optional>
#include <string>

#include "core/common/frames.h"
#include "core/hand/problems.h"
#include "core/hand/xml.h"

namespace regrasp {

inline constexpr double kMaxModelSize = 10;  ///< [m]; anything larger is a unit mistake

/// `text` shown in a message: quoted, cut to 60 characters, without control characters.
std::string Shown(const std::string& text);

class UrdfValues {
 public:
  /// `element`: what the message names, e.g. `link "a1"`.
  UrdfValues(std::string element, Problems* problems)
      : element_(std::move(element)), problems_(problems) {}

  template <typename... Args>
  void Add(int line, fmt::format_string<Args...> format, Args&&... args) const {
    problems_->AddText(line, element_ + ": " + fmt::format(format, std::forward<Args>(args)...));
  }

  /// A finite number; `otherwise` where the attribute is missing, a problem where that is not
  /// given.
  double Number(const XmlNode& node, const char* attribute,
                std::optional<double> otherwise = {}) const;
  /// A number > 0.
  double Positive(const XmlNode& node, const char* attribute) const;
  /// Three finite numbers.
  Vector3d Vector(const XmlNode& node, const char* attribute,
                  std::optional<Vector3d> otherwise = {}) const;
  /// The pose of <origin xyz rpy> below `node`; identity where there is none.
  Isometry3d Origin(const XmlNode& node) const;

  const std::string& element() const { return element_; }

 private:
  bool Parse(const XmlNode& node, const char* attribute, const std::string& text, int count,
             double* out) const;

  std::string element_;
  Problems* problems_;
};

}  // namespace regrasp
