#include "cli/experiment/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <tuple>

#include "cli/experiment/identity.h"
#include "cli/experiment/trial.h"
#include "cli/print/progress_line.h"

namespace regrasp::cli {
namespace {

std::string Describe(const Output& out, const Json& row) {
  std::string text = row.contains("case") ? Plain(row.at("case")) + ", " : "";
  if (row.contains("finger")) {
    text +=
        fmt::format("{} seed {} {} {}: {}", Plain(row.at("finger")), Plain(row.at("seed")),
                    Plain(row.at("noise")), Plain(row.at("estimator")), Plain(row.at("outcome")));
    if (row.at("phi_true_gain").is_number())
      text += fmt::format(", {} {} to {}", out.Phi(), Fixed(row.at("phi_true_initial"), 3),
                          Fixed(row.at("phi_true_final"), 3));
    if (At(row, "share_of_best").is_number())
      text += fmt::format(", {} % of the best", Fixed(row.at("share_of_best"), 1, 100));
  } else {
    text += fmt::format("axis {} seed {} {}: {}", Plain(row.at("axis_W")), Plain(row.at("seed")),
                        Plain(row.at("noise")), Plain(row.at("outcome")));
    if (row.at("rate_deg_min").is_number())
      text += fmt::format(", {} deg/min", Fixed(row.at("rate_deg_min"), 0));
  }
  if (row.at("error").is_string()) text += " (" + Plain(row.at("error")) + ")";
  return text;
}

/// On stderr: one line that is written over on a terminal, else a line for each unit.
class Progress {
 public:
  Progress(Context& context, std::size_t done, std::size_t total)
      : out_(context.out()),
        quiet_(context.options().quiet),
        line_(!quiet_),
        kept_(done),
        done_(done),
        total_(total) {
    if (quiet_) return;
    if (line_.on())
      Bar("");
    else if (kept_ > 0)
      fmt::print(stderr, "{} of {} are there already\n", kept_, total_);
  }
  void Finished(const std::vector<Json>& rows) {
    ++done_;
    if (quiet_) return;
    if (line_.on()) return Bar(Describe(out_, rows.back()));
    for (const Json& row : rows)
      fmt::print(stderr, "{:>{}}/{} {}\n", done_, std::to_string(total_).size(), total_,
                 Describe(out_, row));
  }

 private:
  void Bar(const std::string& what) {
    const double share = total_ > 0 ? static_cast<double>(done_) / static_cast<double>(total_) : 1;
    std::string text = fmt::format("{} {}/{}", out_.Bar(share, 24), done_, total_);
    if (done_ > kept_ && done_ < total_) {
      const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
      const auto left = static_cast<long>(std::lround(elapsed / static_cast<double>(done_ - kept_) *
                                                      static_cast<double>(total_ - done_)));
      text += fmt::format("  {}:{:02} left", left / 60, left % 60);
    }
    line_.Show(text + "  " + what);
  }

  Output& out_;
  bool quiet_;
  ProgressLine line_;
  std::size_t kept_, done_, total_;
  Clock::time_point begin_ = Clock::now();
};

/// Hands out units. Explorations that begin with the same grasp go to one worker, one after the
/// other: its daemon grasps once. (The events of a rotation are counted from before the grasp.)
class Queue {
 public:
  Queue(const Plan& plan, const std::vector<std::size_t>& units) : plan_(plan) {
    for (const std::size_t unit : units) left_[KeyOf(unit)].push_back(unit);
  }
  /// The unit to do after `last`; empty: there is none left.
  std::optional<std::size_t> Next(std::optional<std::size_t> last) {
    if (left_.empty()) return {};
    const auto same = last ? left_.find(KeyOf(*last)) : left_.end();
    const auto begun = [this](const auto& start) { return begun_.contains(start.first); };
    auto start = same != left_.end() ? same : std::find_if_not(left_.begin(), left_.end(), begun);
    if (start == left_.end()) start = left_.begin();  // another worker's: it will not be idle
    begun_.insert(start->first);
    const std::size_t unit = start->second.front();
    start->second.pop_front();
    if (start->second.empty()) left_.erase(start);
    return unit;
  }

 private:
  /// Which case comes first, then noise and seed of an exploration; the unit itself otherwise.
  using Key = std::tuple<std::size_t, std::string, std::int64_t, std::size_t>;
  Key KeyOf(std::size_t index) const {
    const Unit unit = plan_.unit(index);
    if (plan_.rotation()) return {unit.which, "", 0, index};
    return {unit.which, unit.noise, unit.seed, 0};
  }

  const Plan& plan_;
  std::map<Key, std::deque<std::size_t>> left_;
  std::set<Key> begun_;
};

}  // namespace

void RunPlan(Context& context, const Plan& plan, int workers, Store* store) {
  std::vector<std::size_t> left;
  const auto mine = plan.Mine();
  std::copy_if(mine.begin(), mine.end(), std::back_inserter(left),
               [&](std::size_t unit) { return !store->trials().contains(unit); });
  if (left.empty()) return;

  std::mutex mutex;  // of all below
  Progress progress(context, mine.size() - left.size(), mine.size());
  Queue queue(plan, left);
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      std::optional<std::size_t> prepared;  // the case that the daemon is for
      std::unique_ptr<SteppedDaemon> daemon;
      std::optional<std::size_t> unit;
      while (true) {
        {
          const std::lock_guard lock(mutex);
          if (failure) return;
          unit = queue.Next(unit);
        }
        if (!unit) return;
        const Unit what = plan.unit(*unit);
        if (prepared != what.which) {
          daemon.reset();
          daemon = std::make_unique<SteppedDaemon>(plan.DaemonArguments(what.which));
          Prepare(daemon.get(), plan, what.which);
          CheckIdentity(daemon.get(), what.which, plan);
          prepared = what.which;
        }
        const UnitResult result = RunUnit(daemon.get(), plan, what);
        const std::lock_guard lock(mutex);
        store->Add(*unit, result);
        progress.Finished(result.rows);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < std::min<int>(workers, static_cast<int>(left.size())); ++i)
      threads.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace regrasp::cli
