#pragma once

#include "core/gait/object_move.h"
#include "core/session/activity/activity.h"

namespace regrasp {

/// `move`: one motion of the object with all fingers, without a regrasp.
class MoveActivity : public Activity {
 public:
  void Start(const Command& command, const ActivityContext& context) override;
  ActivityStep Update(const ActivityContext& context) override;
  ActivityStep Stop(const ActivityContext& context) override;
  void Dropped(const ActivityContext& context) override;
  template <typename V>
  void Fields(V& v) {
    v("move", move_);
    v("p_WO_start", p_WO_start_);
    v("q_WO_start", q_WO_start_);
  }

 private:
  /// What became of the move so far, by the truth.
  void Assess(const ActivityContext& context) const;

  ObjectMove move_;
  Vector3d p_WO_start_ = Vector3d::Zero();  // true pose when the move began
  Quaterniond q_WO_start_ = Quaterniond::Identity();
};

}  // namespace regrasp
