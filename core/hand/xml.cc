#include "core/hand/xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>

namespace regrasp {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool IsName(char c) {
  const auto u = static_cast<unsigned char>(c);
  return std::isalnum(u) || c == '_' || c == '-' || c == '.' || c == ':' || u >= 0x80;
}

void AppendUtf8(std::uint32_t code, std::string* out) {
  if (code < 0x80) {
    *out += static_cast<char>(code);
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  constexpr unsigned char kLead[] = {0, 0xC0, 0xE0, 0xF0};
  *out += static_cast<char>(kLead[more] | (code >> (6 * more)));
  for (int k = more - 1; k >= 0; --k) *out += static_cast<char>(0x80 | ((code >> (6 * k)) & 0x3F));
}

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  XmlNode Read() {
    if (text_.size() > kMaxXmlBytes)
      Fail(fmt::format("{} bytes; allowed are at most {}", text_.size(), kMaxXmlBytes));
    if (text_.find('\0') != std::string_view::npos) Fail("the file holds a zero byte");
    if (text_.starts_with("\xEF\xBB\xBF")) Skip(3);
    while (ToMarkup()) ReadMarkup();
    if (!open_.empty())
      Fail(fmt::format("<{}> of line {} is not closed", open_.back().name, open_.back().line));
    if (!done_) Fail("there is no element");
    return std::move(root_);
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const { throw XmlError(line_, message); }

  bool At(std::string_view word) const { return text_.substr(at_).starts_with(word); }
  void Skip(std::size_t count) {
    line_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                         text_.begin() + static_cast<std::ptrdiff_t>(at_ + count),
                                         '\n'));
    at_ += count;
  }
  void SkipTo(std::string_view end, const char* what) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) Fail(fmt::format("{} does not end", what));
    Skip(found + end.size() - at_);
  }
  void SkipSpace() {
    std::size_t end = at_;
    while (end < text_.size() && IsSpace(text_[end])) ++end;
    Skip(end - at_);
  }

  /// Moves to the next '<'; false at the end of the text.
  bool ToMarkup() {
    const std::size_t found = text_.find('<', at_);
    const std::size_t end = found == std::string_view::npos ? text_.size() : found;
    if (open_.empty() && !std::all_of(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                      text_.begin() + static_cast<std::ptrdiff_t>(end), IsSpace))
      Fail("text outside of the root element");
    Skip(end - at_);
    return found != std::string_view::npos;
  }

  void ReadMarkup() {
    if (At("<!--")) return SkipTo("-->", "a comment");
    if (At("<?")) return SkipTo("?>", "a processing instruction");
    if (At("<![CDATA[")) return SkipTo("]]>", "a CDATA section");
    if (At("<!DOCTYPE")) {
      const std::size_t end = text_.find('>', at_);
      if (text_.substr(at_, end - at_).find('[') != std::string_view::npos)
        Fail("a DOCTYPE with an internal subset; allowed is none");
      return SkipTo(">", "a DOCTYPE");
    }
    if (At("</")) return Close();
    Open();
  }

  std::string_view ReadName(const char* what) {
    std::size_t end = at_;
    while (end < text_.size() && IsName(text_[end])) ++end;
    if (end == at_) Fail(fmt::format("{} is missing", what));
    const std::string_view name = text_.substr(at_, end - at_);
    Skip(name.size());
    return name;
  }

  void Open() {
    if (done_) Fail("a second root element");
    if (open_.size() >= kMaxXmlDepth) Fail(fmt::format("nested deeper than {}", kMaxXmlDepth));
    if (++elements_ > kMaxXmlElements) Fail(fmt::format("more than {} elements", kMaxXmlElements));
    XmlNode node;
    node.line = line_;
    Skip(1);
    node.name = ReadName("the name after '<'");
    for (SkipSpace(); at_ < text_.size() && !At(">") && !At("/>"); SkipSpace())
      ReadAttribute(&node);
    const bool empty = At("/>");
    if (at_ >= text_.size()) Fail(fmt::format("the tag <{}> does not end", node.name));
    Skip(empty ? 2 : 1);
    open_.push_back(std::move(node));
    if (empty) Pop();
  }

  void ReadAttribute(XmlNode* node) {
    XmlNode::Attribute attribute;
    attribute.name = ReadName(fmt::format("an attribute of <{}>", node->name).c_str());
    SkipSpace();
    if (!At("=")) Fail(fmt::format("<{}>: '=' is missing after {}", node->name, attribute.name));
    Skip(1);
    SkipSpace();
    if (!At("\"") && !At("'"))
      Fail(fmt::format("<{}>: the value of {} is not quoted", node->name, attribute.name));
    const char quote = text_[at_];
    Skip(1);
    const std::size_t end = text_.find(quote, at_);
    const std::string_view raw = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
    if (end == std::string_view::npos || raw.find('<') != std::string_view::npos)
      Fail(fmt::format("<{}>: the value of {} does not end", node->name, attribute.name));
    attribute.value = Decoded(raw);
    Skip(raw.size() + 1);
    if (node->Find(attribute.name))
      Fail(fmt::format("<{}>: {} is given twice", node->name, attribute.name));
    node->attributes.push_back(std::move(attribute));
  }

  std::string Decoded(std::string_view raw) const {
    std::string out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] != '&') {
        out += raw[i];
        continue;
      }
      const std::size_t end = raw.find(';', i);
      const std::string_view name =
          raw.substr(i + 1, end == std::string_view::npos ? 0 : end - i - 1);
      AppendEntity(name, &out);
      i = end;
    }
    return out;
  }

  void AppendEntity(std::string_view name, std::string* out) const {
    constexpr std::pair<std::string_view, char> kNamed[] = {
        {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
    for (const auto& [known, character] : kNamed)
      if (name == known) {
        *out += character;
        return;
      }
    std::uint32_t code = 0;
    if (name.starts_with("#")) {
      const bool hex = name.starts_with("#x");
      const std::string_view digits = name.substr(hex ? 2 : 1);
      const auto [rest, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), code, hex ? 16 : 10);
      if (error != std::errc() || rest != digits.data() + digits.size() || code > 0x10FFFF)
        code = 0;
    }
    if (code == 0) Fail(fmt::format("unknown entity \"&{};\"", name.substr(0, 20)));
    AppendUtf8(code, out);
  }

  void Close() {
    Skip(2);
    const std::string_view name = ReadName("the name after '</'");
    SkipSpace();
    if (!At(">")) Fail(fmt::format("the tag </{}> does not end", name));
    if (open_.empty() || open_.back().name != name)
      Fail(open_.empty() ? fmt::format("</{}> closes nothing", name)
                         : fmt::format("</{}> stands where </{}> of line {} should be", name,
                                       open_.back().name, open_.back().line));
    Skip(1);
    Pop();
  }

  void Pop() {
    XmlNode node = std::move(open_.back());
    open_.pop_back();
    if (!open_.empty()) {
      open_.back().children.push_back(std::move(node));
      return;
    }
    root_ = std::move(node);
    done_ = true;
  }

  std::string_view text_;
  std::size_t at_ = 0, elements_ = 0;
  int line_ = 1;
  std::vector<XmlNode> open_;
  XmlNode root_;
  bool done_ = false;
};

}  // namespace

const std::string* XmlNode::Find(std::string_view attribute) const {
  for (const Attribute& a : attributes)
    if (a.name == attribute) return &a.value;
  return nullptr;
}

const XmlNode* XmlNode::Child(std::string_view child) const {
  for (const XmlNode& c : children)
    if (c.name == child) return &c;
  return nullptr;
}

XmlNode ParseXml(std::string_view text) { return Reader(text).Read(); }

}  // namespace regrasp
