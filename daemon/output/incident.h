#pragma once

/// What led to a drop (or to a fault of the simulation): the frames and events of the last two
/// seconds, what follows from them, and one sentence that says it. I/O thread; afterwards constant.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/session/frame.h"
#include "core/session/parameters.h"
#include "daemon/wire/json.h"

namespace regrasp {

struct PlotInput;

/// Length of the record [s].
inline constexpr double kIncidentWindow = 2.0;

/// What an incident is made of. Frames and events may reach beyond the window on both sides.
struct IncidentSource {
  Event event;                                       ///< kDropped or kFault
  std::vector<std::shared_ptr<const Frame>> frames;  ///< of this run, oldest first
  std::vector<Event> events;                         ///< of this run, oldest first
  JobRecord job;                                     ///< the newest; id 0: none
  Parameters parameters;                             ///< in force at the event
  Json changed = Json::object();  ///< {NAME: value} of those that differ from their defaults
  std::string changed_text;       ///< the same for people
  std::string object;             ///< name of the object
  double dt = 1e-3;               ///< of a tick [s]
};

/// A finger that no longer touched the object at the end of the window.
struct ContactEnd {
  int finger = -1;
  double time_s = 0;    ///< of the last frame in which it touched
  bool lifted = false;  ///< it regrasped: the gait had taken it off
};

/// A finger that held, but pressed with far less force than it was asked for: it leans on another
/// finger, or on the edge of something.
struct WeakFinger {
  int finger = -1;
  double force = 0;  ///< on the object, noise-free, mean of 0.5 to 0.1 s before the onset [N]
  double asked = 0;  ///< the same of what control asked for [N]
};

struct Incident {
  Event event;
  double time_s = 0;                                 ///< of the event
  std::vector<std::shared_ptr<const Frame>> frames;  ///< up to the event
  std::vector<Event> events;                         ///< in the window, the event's tick included
  JobRecord job;                                     ///< the one it ended; id 0: none
  Parameters parameters;
  Json changed = Json::object();  ///< {NAME: value} of those that differ from their defaults
  std::string changed_text;       ///< the same for people
  std::string object;
  double dt = 1e-3;

  // What follows. Times in [s] of the simulation.
  SessionState state = SessionState::kIdle;  ///< before the event
  std::vector<ContactEnd> ends;              ///< in order of time
  double onset_s = 0;  ///< the first of `ends` that was not lifted; the event's time when all touch
  bool has_margin = false;  ///< the next two are known
  double least_margin = 0;  ///< smallest load margin of the grasp until the onset [N]
  double least_margin_s = 0;
  int lifted = -1;               ///< the finger that the gait had taken off at the onset; -1: none
  std::vector<WeakFinger> weak;  ///< in the order of the hand's fingers
  std::vector<Event> disturbances;  ///< pushes and changes of parameters or noise in the window
  std::string cause;                ///< the sentence
};

/// Takes the window out of `source` and draws the conclusions.
Incident MakeIncident(const IncidentSource& source, const HandModel& hand);

/// The record as it is written; docs/incidents.md lists the fields.
Json IncidentJson(const Incident& incident, const HandModel& hand);

/// "incident-4211" for the incident of tick 4211: the record is that with .json, the picture with
/// .png; with "-2" ... where that is taken.
std::string IncidentName(std::int64_t tick);

/// The record as text.
std::string IncidentText(const Incident& incident, const HandModel& hand);

/// Removes the oldest records, with their pictures, until `keep` are left. Throws
/// std::runtime_error.
void PruneIncidents(const std::filesystem::path& directory, std::size_t keep);

/// What its picture is drawn of, the object in its options (snapshots/plots.h).
PlotInput PictureOf(const Incident& incident, const HandModel& hand);

}  // namespace regrasp
