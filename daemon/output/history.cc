#include "daemon/output/history.h"

#include <utility>

namespace regrasp {

bool History::Add(const Frame& frame) {
  // Half a tick of slack: times are multiples of dt, their differences carry rounding.
  const auto due = [&frame](const auto& kept, double period) {
    return kept.empty() || frame.time_s - kept.back()->time_s >= period - 1e-4;
  };
  if (!due(recent_, kRecentPeriod)) return false;
  recent_.push_back(std::make_shared<const Frame>(frame));
  if (recent_.size() > kRecent) recent_.pop_front();
  if (!due(fine_, kFinePeriod)) return false;
  fine_.push_back(recent_.back());
  const bool begins = AddToExploration(fine_.back());
  if (fine_.size() <= kFine) return begins;
  if (aged_++ % kCoarseEvery == 0) coarse_.push_back(fine_.front());
  fine_.pop_front();
  if (coarse_.size() > kCoarse) coarse_.pop_front();
  return begins;
}

bool History::AddToExploration(const std::shared_ptr<const Frame>& frame) {
  const bool same = exploring_ && explorations_.back().frames.back()->job.id == frame->job.id;
  // Before its finger slides a job may make the grasp sure, and then be refused.
  const bool exploring =
      frame->state == SessionState::kExploring && (same || frame->exploration.active);
  if (exploring && !same) {
    explorations_.emplace_back();
    if (explorations_.size() > kExplorations) explorations_.pop_front();
  }
  exploring_ = exploring;
  if (exploring && explorations_.back().frames.size() < kExplorationFrames)
    explorations_.back().frames.push_back(frame);
  return exploring && !same;
}

void History::DescribeExploration(std::string object, std::string changed) {
  explorations_.back().object = std::move(object);
  explorations_.back().changed = std::move(changed);
}

void History::Add(const Event& event) {
  events_.push_back(event);
  if (events_.size() > kEvents) events_.pop_front();
}

void History::Clear() {
  fine_.clear();
  recent_.clear();
  coarse_.clear();
  events_.clear();
  aged_ = 0;
  exploring_ = false;
}

std::vector<std::shared_ptr<const Frame>> History::Frames(double last_s) const {
  std::vector<std::shared_ptr<const Frame>> frames;
  if (fine_.empty()) return frames;
  const double since = last_s > 0 ? fine_.back()->time_s - last_s : -1.0;
  frames.reserve(size());
  for (const auto* part : {&coarse_, &fine_})
    for (const auto& frame : *part)
      if (frame->time_s >= since) frames.push_back(frame);
  return frames;
}

}  // namespace regrasp
