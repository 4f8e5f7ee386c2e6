#pragma once

/// Model files as XML, read by tinyxml2 within limits: files are not trusted. What tinyxml2 takes
/// and XML does not allow (an unknown entity, a second root, text around the root, a closing tag
/// too many) is refused, and so is what nobody needs in a model (a DOCTYPE with an internal
/// subset).

#include <tinyxml2.h>

#include <stdexcept>
#include <string>

namespace regrasp {

/// Where a text stops being XML.
class XmlError : public std::runtime_error {
 public:
  XmlError(int line, const std::string& message) : std::runtime_error(message), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

inline constexpr std::size_t kMaxXmlBytes = 16u << 20;
inline constexpr int kMaxXmlDepth = 64;
inline constexpr int kMaxXmlElements = 100000;
inline constexpr int kMaxXmlAttributes = 200;  ///< of one element

/// Reads `text` into `document`, whose root element it returns. Throws XmlError.
tinyxml2::XMLElement* ParseXml(const std::string& text, tinyxml2::XMLDocument* document);

}  // namespace regrasp
