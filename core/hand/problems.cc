#include "core/hand/problems.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "core/files/names.h"
#include "core/hand/model_report.h"

namespace regrasp {
namespace {

constexpr std::size_t kShown = 50;  // messages; the others are counted

}  // namespace

void Problems::AddText(int line, const std::string& message) {
  Keep(line > 0 ? fmt::format("{}:{}: {}", file_, line, message)
                : fmt::format("{}: {}", file_, message));
}

void Problems::Warn(int line, std::string element, std::string text) {
  if (report_) report_->warnings.push_back({file_, line, std::move(element), std::move(text)});
}

void Problems::Keep(const std::string& given) {
  const std::string message = ShownLines(given);
  ++count_;
  if (messages_.size() < kShown &&
      std::find(messages_.begin(), messages_.end(), message) == messages_.end())
    messages_.push_back(message);
}

void Problems::ThrowIfAny() const {
  if (empty()) return;
  if (messages_.size() == 1) throw ModelError(messages_.front());
  std::string text =
      fmt::format("{} errors:\n  {}", messages_.size(), fmt::join(messages_, "\n  "));
  if (messages_.size() == kShown && count_ > kShown)
    text += fmt::format("\n  and {} more", count_ - kShown);
  throw ModelError(text);
}

std::string ModelWarning::Line() const {
  return ShownText(fmt::format("{}{}: {}{}{}", file, line > 0 ? fmt::format(":{}", line) : "",
                               element, element.empty() ? "" : ": ", text));
}

}  // namespace regrasp
