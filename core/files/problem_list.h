#pragma once

/// What is wrong with something from outside, gathered so that its reader hears of everything at
/// once.

#include <cstddef>
#include <string>
#include <vector>

namespace regrasp {

class ProblemList {
 public:
  static constexpr std::size_t kMost = 50;  ///< kept; the others are counted

  ProblemList() = default;
  explicit ProblemList(const std::string& message) { Add(message); }

  /// A message, as it may be shown to people (ShownText: one line). `line`: where it stands in its
  /// file; those without one (0) are told last. What is there already is not told twice.
  void Add(int line, const std::string& message);
  void Add(const std::string& message) { Add(0, message); }
  /// What another list holds, told after what has a line here, with those that it only counted.
  void Add(const ProblemList& other);
  /// So many more, of which nothing is known but that they are there.
  void AddUnkept(std::size_t count) { count_ += count, unkept_ += count; }

  bool empty() const { return count_ == 0; }
  /// Of what was added, also what was there already.
  std::size_t count() const { return count_; }
  /// In the order of their lines, then as they were added; the last says how many were too many to
  /// be kept.
  std::vector<std::string> Messages() const;
  /// One message as it is; of several their number, then one a line.
  std::string Text() const;

 private:
  struct Problem {
    int line;
    std::string message;
  };
  std::vector<Problem> Sorted() const;

  std::vector<Problem> kept_;
  std::size_t count_ = 0, unkept_ = 0;
};

}  // namespace regrasp
