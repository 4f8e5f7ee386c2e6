#pragma once

/// A small reader of XML for model files: elements, attributes, the line each begins on. Text
/// between elements, comments, processing instructions, CDATA and a DOCTYPE without an internal
/// subset are skipped; the five named entities and numeric ones are known, others are refused, so
/// that nothing expands. Files are not trusted: size, depth and counts are bounded, and nothing
/// recurses.

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace regrasp {

/// Where a text stops being XML.
class XmlError : public std::runtime_error {
 public:
  XmlError(int line, const std::string& message) : std::runtime_error(message), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

struct XmlNode {
  struct Attribute {
    std::string name, value;
  };
  std::string name;
  int line = 0;  ///< of its "<", from 1
  std::vector<Attribute> attributes;
  std::vector<XmlNode> children;

  /// The value of an attribute, or nullptr.
  const std::string* Find(std::string_view attribute) const;
  /// The first child element of this name, or nullptr.
  const XmlNode* Child(std::string_view child) const;
};

inline constexpr std::size_t kMaxXmlBytes = 16u << 20;
inline constexpr std::size_t kMaxXmlDepth = 64;
inline constexpr std::size_t kMaxXmlElements = 100000;

/// The root element of a document. Throws XmlError.
XmlNode ParseXml(std::string_view text);

}  // namespace regrasp
