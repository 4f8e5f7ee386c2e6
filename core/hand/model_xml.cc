#include "core/hand/model_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace regrasp {
namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Refuses what would cost time or memory out of proportion: tinyxml2 compares each attribute with
/// those before it, and keeps a node for every "<".
void CheckText(std::string_view text) {
  if (text.size() > kMaxXmlBytes)
    throw XmlError(1, fmt::format("{} bytes; allowed are at most {}", text.size(), kMaxXmlBytes));
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw XmlError(1, "the file is UTF-16; must be UTF-8");
  int line = 1, elements = 0, attributes = 0;
  char before = 0;  // but for spaces
  for (const char c : text) {
    if (c == '\0') throw XmlError(line, "the file holds a zero byte");
    if (c == '\n') ++line;
    if (c == '<') attributes = 0;
    if (c == '<' && ++elements > 3 * kMaxXmlElements)  // opened, closed, a comment between
      throw XmlError(line, fmt::format("more than {} elements", kMaxXmlElements));
    if ((c == '"' || c == '\'') && before == '=' && ++attributes > kMaxXmlAttributes)
      throw XmlError(line, fmt::format("more than {} attributes in a tag", kMaxXmlAttributes));
    if (!IsSpace(c)) before = c;
  }
}

/// The line on which the last tag `name` at or before a line begins: tinyxml2 tells where it gave
/// up.
int LineOfTag(std::string_view text, std::string_view name, int line) {
  std::size_t end = 0;
  for (int k = 0; k < line && end != std::string_view::npos; ++k)
    end = text.find('\n', end + (k > 0));
  const std::size_t at = text.substr(0, end).rfind(fmt::format("<{}", name));
  if (at == std::string_view::npos) return line;
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

[[noreturn]] void FailAsRead(const XMLDocument& document, std::string_view text) {
  // "...: XMLElement name=NAME"
  const std::string_view report = document.ErrorStr();
  const std::size_t at = report.find("name=");
  const std::string_view name = at == std::string_view::npos ? "" : report.substr(at + 5);
  const int line = document.ErrorLineNum();
  switch (document.ErrorID()) {
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      throw XmlError(line, fmt::format("nested deeper than {}", kMaxXmlDepth));
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      throw XmlError(line, fmt::format("<{}> is not closed before its parent or the file ends; "
                                       "must be </{}>",
                                       name, name));
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      throw XmlError(LineOfTag(text, name, line),
                     fmt::format("<{}>: an attribute (near line {}) does not end, has no quoted "
                                 "value, or is given twice",
                                 name, line));
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      throw XmlError(line, fmt::format("the tag <{}> does not end", name));
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      throw XmlError(line, "a comment does not end");
    case tinyxml2::XML_ERROR_PARSING_CDATA:
      throw XmlError(line, "a CDATA section does not end");
    case tinyxml2::XML_ERROR_PARSING_DECLARATION:
      throw XmlError(line, "<? ... ?> must end, and stand before the first element or comment");
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      throw XmlError(line, "text outside of the root element, or an element that is not closed");
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      throw XmlError(1, "there is no element");
    default:
      throw XmlError(line, "this is no element, comment or text");
  }
}

/// An entity that tinyxml2 did not know stands in the value as it was written.
void CheckEntities(const XMLAttribute& attribute) {
  const std::string_view value = attribute.Value();
  for (std::size_t at = value.find('&'); at != value.npos; at = value.find('&', at + 1)) {
    const std::size_t end = value.find_first_of("; &", at + 1);
    if (end != value.npos && end > at + 1 && value[end] == ';')
      throw XmlError(attribute.GetLineNum(),
                     fmt::format("unknown entity \"{}\"", value.substr(at, end + 1 - at)));
  }
}

void CheckElement(const XMLElement& element, int depth, int* elements) {
  if (depth > kMaxXmlDepth)
    throw XmlError(element.GetLineNum(), fmt::format("nested deeper than {}", kMaxXmlDepth));
  if (++*elements > kMaxXmlElements)
    throw XmlError(element.GetLineNum(), fmt::format("more than {} elements", kMaxXmlElements));
  for (const XMLAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next())
    CheckEntities(*a);
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement())
    CheckElement(*child, depth + 1, elements);
}

}  // namespace

XMLElement* ParseXml(const std::string& text, XMLDocument* document) {
  CheckText(text);
  // tinyxml2 stops without a word at a closing tag too many: then it does not come to this.
  constexpr std::string_view kEnd = "end of the file";
  const std::string marked = fmt::format("{}<!{}>", text, kEnd);
  if (document->Parse(marked.c_str(), marked.size()) != tinyxml2::XML_SUCCESS)
    FailAsRead(*document, text);
  XMLElement* root = nullptr;
  for (XMLNode* node = document->FirstChild(); node != nullptr; node = node->NextSibling()) {
    const int line = node->GetLineNum();
    if (node->ToUnknown() && std::string_view(node->Value()).find('[') != std::string_view::npos)
      throw XmlError(line, "a DOCTYPE with an internal subset; allowed is none");
    if (node->ToText()) throw XmlError(line, "text outside of the root element");
    if (node->ToElement() && root) throw XmlError(line, "a second root element");
    if (node->ToElement()) root = node->ToElement();
  }
  const XMLNode* last = document->LastChild();
  if (last == nullptr || !last->ToUnknown() || last->Value() != kEnd)
    throw XmlError(last == nullptr ? 1 : last->GetLineNum(),
                   "a closing tag too many: what follows is not read");
  if (root == nullptr) throw XmlError(1, "there is no element");
  int elements = 0;
  CheckElement(*root, 1, &elements);
  return root;
}

}  // namespace regrasp
