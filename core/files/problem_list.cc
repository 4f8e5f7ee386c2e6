#include "core/files/problem_list.h"

#include <algorithm>
#include <climits>

#include "core/files/names.h"

namespace regrasp {

void ProblemList::Add(int line, const std::string& message) {
  ++count_;
  std::string shown = ShownText(message);
  if (kept_.size() < kMost && std::ranges::find(kept_, shown, &Problem::message) == kept_.end())
    kept_.push_back({line, std::move(shown)});
}

std::vector<std::string> ProblemList::Messages() const {
  std::vector<Problem> sorted = kept_;
  std::ranges::stable_sort(
      sorted, {}, [](const Problem& problem) { return problem.line > 0 ? problem.line : INT_MAX; });
  std::vector<std::string> messages;
  for (Problem& problem : sorted) messages.push_back(std::move(problem.message));
  if (kept_.size() == kMost && count_ > kMost)
    messages.push_back("and " + std::to_string(count_ - kMost) + " more");
  return messages;
}

std::string ProblemList::Text() const {
  const std::vector<std::string> messages = Messages();
  if (messages.size() == 1) return messages.front();
  std::string text = std::to_string(kept_.size()) + " errors:";
  for (const std::string& message : messages) text += "\n  " + message;
  return text;
}

}  // namespace regrasp
