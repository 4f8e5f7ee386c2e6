#include "core/exploration/finger_exploration.h"

namespace regrasp {

void FingerExploration::Start(const Request& request) {
  request_ = request;
  GuidedSlide::Request slide;
  slide.finger = request.finger;
  slide.criterion = request.criterion;
  slide.estimator = request.estimator;
  slide.seed = request.seed;
  slide.max_cycles = request.max_cycles;
  slide.turn_axis_W = request.turn_axis_W;
  slide_.Start(slide);
}

void FingerExploration::Update(const ControlTick& tick, HybridController* controller,
                               FingerTasks* tasks) {
  const ExplorationParameters& parameters = tick.exploration;
  SlideProfile profile;
  profile.transfer_s = parameters.transfer_s;
  profile.grip_force = tick.control.grip_force;
  profile.settle_s = parameters.settle_s;
  profile.return_limit_s = parameters.return_limit_s;
  profile.tries = parameters.tries;
  slide_.Update(tick, profile, {}, controller, tasks);
}

}  // namespace regrasp
