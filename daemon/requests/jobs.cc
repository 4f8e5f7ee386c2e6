#include "daemon/requests/jobs.h"

#include <algorithm>

namespace regrasp {

bool Ended(JobState state) {
  return state == JobState::kDone || state == JobState::kFailed || state == JobState::kCancelled;
}

JobRecord& JobTable::Add(JobMethod method) {
  // The oldest goes, but never one that somebody may still wait for: only a few can be unfinished.
  if (jobs_.size() >= kKept) {
    const auto oldest =
        std::ranges::find_if(jobs_, [](const JobRecord& j) { return Ended(j.state); });
    if (oldest != jobs_.end()) jobs_.erase(oldest);
  }
  ++changes_;
  JobRecord& job = jobs_.emplace_back();
  job.id = ++last_id_;
  job.method = method;
  return job;
}

void JobTable::Withdraw(std::int64_t id) {
  if (jobs_.empty() || jobs_.back().id != id) return;
  ++changes_;
  jobs_.pop_back();
  --last_id_;
}

JobRecord* JobTable::FindMutable(std::int64_t id) {
  const auto it = std::ranges::lower_bound(jobs_, id, {}, &JobRecord::id);
  return it != jobs_.end() && it->id == id ? &*it : nullptr;
}

const JobRecord* JobTable::Find(std::int64_t id) const {
  return const_cast<JobTable*>(this)->FindMutable(id);
}

void JobTable::Update(const JobRecord& record) {
  JobRecord* known = FindMutable(record.id);
  if (!known || Ended(known->state)) return;
  ++changes_;
  // A job that ended before it began has no start, and its fields are those of the request.
  const ExploreResult requested = known->explore;
  const MoveResult wanted = known->move;
  *known = record;
  if (record.start_tick < 0) {
    known->move.offset_m = wanted.offset_m;
    known->move.rotation_rad = wanted.rotation_rad;
  }
  if (record.start_tick < 0 && record.explore.finger < 0) {
    const ExploreReason reason = record.explore.reason;
    known->explore = requested;
    known->explore.reason = reason;
  }
  if (!Ended(record.state)) return;
  std::vector<Waiter> due;
  for (auto it = waiters_.begin(); it != waiters_.end();) {
    if (it->second.job == record.id) {
      due.push_back(std::move(it->second.waiter));
      it = waiters_.erase(it);
    } else {
      ++it;
    }
  }
  const JobRecord ended = *known;
  for (const Waiter& waiter : due) waiter(ended);
}

const JobRecord* JobTable::Unfinished() const {
  for (auto it = jobs_.rbegin(); it != jobs_.rend(); ++it)
    if (!Ended(it->state) && it->method != JobMethod::kStep) return &*it;
  return nullptr;
}

const JobRecord* JobTable::Restoring() const {
  const JobRecord* job = Unfinished();
  return job && job->method == JobMethod::kRestore ? job : nullptr;
}

const JobRecord* JobTable::UnfinishedStep() const {
  for (auto it = jobs_.rbegin(); it != jobs_.rend(); ++it)
    if (!Ended(it->state) && it->method == JobMethod::kStep) return &*it;
  return nullptr;
}

std::uint64_t JobTable::Wait(std::int64_t id, Waiter waiter) {
  const JobRecord* job = Find(id);
  if (job && Ended(job->state)) {
    waiter(*job);
    return 0;
  }
  waiters_.emplace(++last_key_, Waiting{id, std::move(waiter)});
  return last_key_;
}

void JobTable::StopWaiting(std::uint64_t key) { waiters_.erase(key); }

}  // namespace regrasp
