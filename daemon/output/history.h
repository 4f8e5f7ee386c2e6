#pragma once

/// The frames that pictures are drawn from: the last minute at 50 Hz, the nine minutes before at 5
/// Hz (about 35 MB in all), and the last five seconds at 100 Hz. I/O thread only.

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/session/frame.h"

namespace regrasp {

class History {
 public:
  static constexpr double kFinePeriod = 0.02;   ///< [s of simulated time]
  static constexpr std::size_t kFine = 3000;    ///< frames: 60 s
  static constexpr std::size_t kCoarse = 2700;  ///< frames: 540 s
  static constexpr std::size_t kCoarseEvery =
      10;                                        ///< one of so many fine frames is kept for longer
  static constexpr double kRecentPeriod = 0.01;  ///< [s of simulated time]
  static constexpr std::size_t kRecent = 500;    ///< frames: 5 s, so that 2 s before an event are
                                                 ///< still there when the event is looked at
  static constexpr std::size_t kEvents = 4096;
  static constexpr std::size_t kExplorations = 2;
  static constexpr std::size_t kExplorationFrames = 6000;  ///< of one; 120 s, the rest is cut off

  /// An exploration and what its frames do not tell.
  struct Exploration {
    std::vector<std::shared_ptr<const Frame>> frames;
    std::string object, changed;  ///< its name; the parameters that differed from their defaults
  };

  /// Keeps the frame when kRecentPeriod has passed since the last one kept, for long when
  /// kFinePeriod has. True when an exploration begins with it, which is to be described.
  bool Add(const Frame& frame);
  void DescribeExploration(std::string object, std::string changed);
  void Add(const Event& event);
  /// Forgets everything but the explorations: a new run began.
  void Clear();

  /// Frames of the last `last_s` seconds of simulated time (0 = all), oldest first.
  std::vector<std::shared_ptr<const Frame>> Frames(double last_s) const;
  /// The last kRecent frames at 100 Hz, oldest first.
  std::vector<std::shared_ptr<const Frame>> Recent() const {
    return {recent_.begin(), recent_.end()};
  }
  /// The last explorations (jobs, not those of a gait) from where the finger begins to
  /// slide, oldest first, at most kExplorations of them. They outlive a reset, so that runs can be
  /// compared.
  std::vector<Exploration> Explorations() const {
    return {explorations_.begin(), explorations_.end()};
  }
  /// Events kept, oldest first.
  std::vector<Event> Events() const { return {events_.begin(), events_.end()}; }
  std::size_t size() const { return fine_.size() + coarse_.size(); }

 private:
  bool AddToExploration(const std::shared_ptr<const Frame>& frame);

  std::deque<std::shared_ptr<const Frame>> coarse_, fine_, recent_;
  std::deque<Exploration> explorations_;
  bool exploring_ = false;  ///< the last frame kept belongs to explorations_.back()
  std::size_t aged_ = 0;    ///< frames that have left the fine part
  std::deque<Event> events_;
};

}  // namespace regrasp
