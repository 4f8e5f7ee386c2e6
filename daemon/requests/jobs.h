#pragma once

/// The records of jobs as clients see them, and the clients that wait for them. I/O thread only.

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "core/session/job.h"

namespace regrasp {

class JobTable {
 public:
  static constexpr std::size_t kKept = 256;
  using Waiter = std::function<void(const JobRecord&)>;

  /// A new job in state queued, with the next number.
  JobRecord& Add(JobMethod method);
  /// Takes back the job that Add() just made: its command could not be queued.
  void Withdraw(std::int64_t id);
  /// Takes over what the control thread reports: a running job's progress or a finished job.
  /// Reports that are older than what is known change nothing. Waiters of a finished job are
  /// called.
  void Update(const JobRecord& record);
  /// Grows with every change of a record.
  std::uint64_t changes() const { return changes_; }
  /// The record, or null when there is none (any more).
  const JobRecord* Find(std::int64_t id) const;
  /// The last kKept jobs, oldest first.
  const std::deque<JobRecord>& jobs() const { return jobs_; }
  /// A job that has not ended, other than a step; null when there is none.
  const JobRecord* Unfinished() const;
  /// The restore of a checkpoint that has not ended, or null.
  const JobRecord* Restoring() const;
  /// The same for steps.
  const JobRecord* UnfinishedStep() const;

  /// Calls `waiter` once, when the job ends (at once, if it has). Returns a key for StopWaiting().
  std::uint64_t Wait(std::int64_t id, Waiter waiter);
  void StopWaiting(std::uint64_t key);

 private:
  JobRecord* FindMutable(std::int64_t id);

  std::deque<JobRecord> jobs_;
  std::int64_t last_id_ = 0;
  std::uint64_t changes_ = 0;
  struct Waiting {
    std::int64_t job;
    Waiter waiter;
  };
  std::map<std::uint64_t, Waiting> waiters_;
  std::uint64_t last_key_ = 0;
};

/// True in done, failed and cancelled.
bool Ended(JobState state);

}  // namespace regrasp
