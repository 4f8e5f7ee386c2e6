#pragma once

/// What `top` knows: the newest sample of each topic, the last 30 s of what it draws as curves, and
/// the last events. No terminal, no socket, no clock: samples come in, panels read.

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "cli/client/client.h"

namespace regrasp::cli {

/// Values over simulated time; those older than kSeconds before the newest are forgotten.
class Series {
 public:
  static constexpr double kSeconds = 30;
  struct Point {
    double time_s, value;
  };
  void Add(double time_s, double value);
  void Clear() { points_.clear(); }
  const std::deque<Point>& points() const { return points_; }

 private:
  std::deque<Point> points_;
};

class DashboardModel {
 public:
  static constexpr std::size_t kEvents = 200;

  /// Takes in a sample of `status`, `contacts`, `quality` or `events`; other topics are ignored.
  /// When time runs backwards a new run has begun: curves and slips are forgotten.
  void Add(const std::string& topic, const Json& sample);

  /// The record of a job that began before; oldest first.
  void Remember(const Json& job);

  const Json& status() const { return status_; }
  const Json& contacts() const { return contacts_; }
  const Json& quality() const { return quality_; }
  const std::deque<Json>& events() const { return events_; }

  /// Names of the fingers in the daemon's order.
  std::vector<std::string> Fingers() const;
  /// The finger that explores now, or "".
  std::string ExploringFinger() const;
  /// The record of the exploration that runs, else of the last one seen; null before the first.
  const Json& exploration_job() const { return exploration_job_; }
  /// Manipulability of a finger, and stability of the holding grasp.
  const Series& manipulability(const std::string& finger) const;
  const Series& stability() const { return stability_; }
  /// Slip events of the running or last job.
  int slips() const { return slips_; }
  double last_slip_s() const { return last_slip_s_; }
  double time_s() const { return time_s_; }

 private:
  void Advance(double time_s);

  Json status_, contacts_, quality_, exploration_job_;
  std::deque<Json> events_;
  std::map<std::string, Series> manipulability_;
  Series stability_;
  double time_s_ = 0, last_slip_s_ = 0;
  int slips_ = 0;
};

/// H hold, E explore, M move, - free.
char RoleLetter(const std::string& role);

}  // namespace regrasp::cli
