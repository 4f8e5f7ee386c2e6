#include "core/hand/problems.h"

#include "core/files/names.h"
#include "core/hand/model_report.h"

namespace regrasp {

void Problems::AddText(int line, const std::string& message) {
  names_no_model_ = false;
  list_.Add(line, line > 0 ? fmt::format("{}:{}: {}", file_, line, message)
                           : fmt::format("{}: {}", file_, message));
}

void Problems::Add(const ModelError& error) {
  names_no_model_ = empty() && error.names_no_model;
  list_.Add(error.problems);
}

void Problems::Warn(int line, std::string element, std::string text) {
  if (report_) report_->warnings.push_back({file_, line, std::move(element), std::move(text)});
}

void Problems::ThrowIfAny() const {
  if (empty()) return;
  ModelError error(list_);
  error.names_no_model = names_no_model_;
  throw error;
}

std::string ModelWarning::Line() const {
  return ShownText(fmt::format("{}{}: {}{}{}", file, line > 0 ? fmt::format(":{}", line) : "",
                               element, element.empty() ? "" : ": ", text));
}

}  // namespace regrasp
