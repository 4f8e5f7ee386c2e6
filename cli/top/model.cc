#include "cli/top/model.h"

#include "cli/print/print.h"

namespace regrasp::cli {

void Series::Add(double time_s, double value) {
  if (!points_.empty() && time_s <= points_.back().time_s) return;
  points_.push_back({time_s, value});
  while (points_.front().time_s < time_s - kSeconds) points_.pop_front();
}

void DashboardModel::Advance(double time_s) {
  if (time_s < time_s_) {
    manipulability_.clear();
    stability_.Clear();
    slips_ = 0;
  }
  time_s_ = time_s;
}

void DashboardModel::Remember(const Json& job) {
  if (At(job, "method") == "explore") exploration_job_ = job;
}

void DashboardModel::Add(const std::string& topic, const Json& sample) {
  if (topic == "events") {
    const std::string kind = Plain(At(sample, "kind"));
    if (kind == "job_started") slips_ = 0;
    if (kind == "slip") {
      ++slips_;
      last_slip_s_ = sample.value("t_s", 0.0);
    }
    events_.push_back(sample);
    if (events_.size() > kEvents) events_.pop_front();
    return;
  }
  if (At(sample, "time_s").is_number()) Advance(At(sample, "time_s"));
  if (topic == "status") {
    status_ = sample;
    Remember(At(sample, "job"));
  } else if (topic == "contacts") {
    contacts_ = sample;
  } else if (topic == "quality") {
    quality_ = sample;
    if (At(sample, "stability").is_number()) stability_.Add(time_s_, At(sample, "stability"));
    for (const auto& [name, finger] : Named(At(sample, "fingers"), "finger"))
      if (At(finger, "manipulability").is_number())
        manipulability_[name].Add(time_s_, At(finger, "manipulability"));
  }
}

std::vector<std::string> DashboardModel::Fingers() const {
  std::vector<std::string> names;
  for (const auto& [name, finger] : Named(At(contacts_, "fingers"), "finger"))
    names.push_back(name);
  return names;
}

std::string DashboardModel::ExploringFinger() const {
  for (const auto& [name, finger] : Named(At(contacts_, "fingers"), "finger"))
    if (At(finger, "role") == "explore") return name;
  return "";
}

const Series& DashboardModel::manipulability(const std::string& finger) const {
  static const Series kNone;
  const auto it = manipulability_.find(finger);
  return it == manipulability_.end() ? kNone : it->second;
}

char RoleLetter(const std::string& role) {
  return role == "hold" ? 'H' : role == "explore" ? 'E' : role == "move" ? 'M' : '-';
}

}  // namespace regrasp::cli
