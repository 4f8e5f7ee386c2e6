#pragma once

/// The figures of the paper from one run each, and the paper's claims beside what these runs
/// measured: shared by `regrasp demo` and `regrasp experiment paper`.

#include <filesystem>
#include <string>
#include <vector>

#include "cli/client/context.h"
#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

/// One line of the table of claims.
struct Claim {
  std::string claim;  ///< empty: goes on with the claim above
  std::string measured;
  bool shown = true;
};

class Figures {
 public:
  /// `daemon` writes into the directory `output`; `seed` is that of every run; rotations
  /// make `turns` turns. Says on stderr what it does.
  Figures(Context& context, SteppedDaemon* daemon, std::filesystem::path output, std::int64_t seed,
          double turns = 1)
      : context_(context),
        daemon_(*daemon),
        output_(std::move(output)),
        seed_(seed),
        turns_(turns) {}

  /// Figure 1: the object in the hand. Throws CliError(kFailed) when it cannot be grasped.
  void Grasp();
  /// Each finger explores; figure 2, and the same of the little finger, whose better manipulability
  /// costs stability; `repeats` explorations of the ring finger with other start gradients. What
  /// needs a finger that the hand does not have is left out.
  void Explorations(int repeats);
  /// Figures 3a and 3b: one rotation with fingers that return to their first contact, one with
  /// fingers that explore.
  void Rotations();

  const std::vector<Claim>& claims() const { return claims_; }
  /// The hand held the object to the end of every step.
  bool held() const { return held_; }
  /// Everything measured: members hold, explore, figure2, tradeoff, repeats, rotate,
  /// pictures.
  const Json& measured() const { return measured_; }

 private:
  struct Exploration {
    Json record;
    std::string start_hash;
    double first_stability = 0, least_stability = 1e300, last_stability = 0;
  };

  void Say(const std::string& text);
  void GraspObject();
  Exploration Explore(const std::string& finger, const std::string& criterion,
                      std::int64_t gradient_seed);
  void Figure2();
  void Tradeoff();
  void Repeats(int repeats);
  void Rotation(const std::string& preset, const std::string& name);
  void Picture(const std::string& name, const std::string& file, double last_s = 0);
  void Add(const std::string& claim, const std::string& measured, bool shown) {
    claims_.push_back({claim, measured, shown});
  }
  /// The object must stay in the hand, whatever else a step shows.
  void MustHold(const std::string& step);

  Context& context_;
  SteppedDaemon& daemon_;
  std::filesystem::path output_;
  std::int64_t seed_;
  std::int64_t start_seed_ = seed_;  ///< of the start that is grasped
  double turns_;
  std::vector<Claim> claims_;
  bool held_ = true;
  Json measured_ = Json::object();
};

}  // namespace regrasp::cli
