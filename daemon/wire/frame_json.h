#pragma once

/// Frames, events and job records as clients see them: names instead of indices, units in the
/// names.

#include "core/hand/hand_model.h"
#include "core/session/frame.h"
#include "core/session/parameters.h"
#include "daemon/wire/json.h"

namespace regrasp {

/// What the controller senses at each fingertip.
Json ContactsJson(const Frame& frame, const HandModel& hand, const Parameters& parameters);
/// Joints: sensed angles, applied torques, limits.
Json JointsJson(const Frame& frame, const HandModel& hand);
/// Quality measures. With `on_request` also
/// those that no frame has: about a millisecond.
Json QualityJson(const Frame& frame, const HandModel& hand, bool on_request);
/// What only the simulator knows.
Json TruthJson(const Frame& frame, const HandModel& hand);
/// Where the finger gait is, while rotating; `active` false otherwise.
Json GaitJson(const GaitFrame& gait, const HandModel& hand);
/// One event, with the name of the incident's record where it has one; `dt` [s] turns its tick into
/// a time.
Json EventNewsJson(const Event& event, const HandModel& hand, double dt);
/// Preset name and every level.
Json NoiseJson(const NoiseLevels& levels);
/// One job record, with the fields of its method at the top level; `dt` [s] turns its ticks into
/// times.
Json JobJson(const JobRecord& job, const HandModel& hand, double dt);
/// A parameter's value as `param.set` takes it: a number, three, true, false or a word.
Json ParameterValueJson(const ParameterInfo& info, const Vector3d& value);

}  // namespace regrasp
