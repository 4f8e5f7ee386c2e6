#include "core/gait/stance_search.h"

#include "core/quality/load_margin.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStream = 2000;

}  // namespace

void StanceSearch::Start(const Stance& first, const Stance& stance, FingerSet fingers, int without,
                         double max_shift, std::uint64_t seed) {
  *this = StanceSearch();
  first_ = first;
  best_ = stance;
  fingers_ = fingers;
  without_ = without;
  max_shift_ = max_shift;
  random_ = RandomStream(seed, kStream);
}

void StanceSearch::Step(const Vector3d& weight, double mu, double torque_scale, double max_force,
                        double step_size) {
  Stance trial = best_;
  if (evaluations_ > 0) {
    for (std::size_t i = 0; i < trial.size(); ++i) {
      if (static_cast<int>(i) == without_) continue;
      const Vector3d step = TangentPart(step_size * random_.Normal3(), trial[i].normal_W);
      const StanceContact moved = Shifted(trial[i], step);
      if ((moved.p_OC_W - first_[i].p_OC_W).norm() <= max_shift_) trial[i] = moved;
    }
  }
  Grasp grasp;
  for (int i : fingers_.without(without_))
    grasp.push_back({trial[i].p_OC_W, -trial[i].normal_W, mu});
  const double margin = LoadMargin({grasp.data(), grasp.size()}, weight, torque_scale, max_force);
  ++evaluations_;
  if (margin <= margin_) return;
  margin_ = margin;
  best_ = trial;
}

}  // namespace regrasp
