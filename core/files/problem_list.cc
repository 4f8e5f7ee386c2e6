#include "core/files/problem_list.h"

#include <algorithm>
#include <climits>

#include "core/files/names.h"

namespace regrasp {

void ProblemList::Add(int line, const std::string& message) {
  ++count_;
  std::string shown = ShownText(message);
  if (std::ranges::find(kept_, shown, &Problem::message) != kept_.end()) return;
  if (kept_.size() < kMost)
    kept_.push_back({line, std::move(shown)});
  else
    ++unkept_;
}

void ProblemList::Add(const ProblemList& other) {
  for (const Problem& problem : other.Sorted()) Add(problem.message);
  AddUnkept(other.unkept_);
}

std::vector<ProblemList::Problem> ProblemList::Sorted() const {
  std::vector<Problem> sorted = kept_;
  std::ranges::stable_sort(
      sorted, {}, [](const Problem& problem) { return problem.line > 0 ? problem.line : INT_MAX; });
  return sorted;
}

std::vector<std::string> ProblemList::Messages() const {
  std::vector<std::string> messages;
  for (Problem& problem : Sorted()) messages.push_back(std::move(problem.message));
  if (unkept_ > 0) messages.push_back("and " + std::to_string(unkept_) + " more");
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
