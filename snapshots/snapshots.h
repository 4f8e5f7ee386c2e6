#pragma once

/// Pictures of a run, drawn with OpenCV (which appears in no header of this folder but canvas.h).
///
/// Every function draws one picture into `path`; the suffix chooses the format
/// (kPlotSuffixes).
/// The input is what leaves a session, Frame and Event, oldest first and in one run: a picture
/// never touches the simulator. All of them may be called from any thread; none keeps state.
///
/// Errors: std::runtime_error whose text names the path and the cause: a suffix that is not listed,
/// a missing font (package fonts-dejavu-core), a file that cannot be written; PictureRefused where
/// there is nothing to draw, or a size outside 400 x 300 .. 8000 x 8000 px (snapshots/refused.h).

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/hand/object_model.h"
#include "core/session/frame.h"
#include "core/shape/felt_surface.h"

namespace regrasp {

/// A picture in memory instead of a file: width x height x {blue, green, red}, row by row.
using Pixels = std::vector<std::uint8_t>;

struct PlotOptions {
  double last_s = 0;  ///< only the newest seconds of the history; 0 = all [s]
  int width = 1600;   ///< [px]
  int height = 1000;  ///< [px]
  /// As printed, 0: for a screen. Text is at least `font_pt` high at any width, in a narrow picture
  /// with the legends below; PlotIncident has no such layout, its text is that high from 165 mm on.
  double width_mm = 0;
  double font_pt = 7;  ///< smallest text on paper
  double dpi = 0;      ///< of a raster picture with a printed width; 0: `width` pixels
  std::string title;   ///< empty: a title that says what the picture shows
  bool with_title = true;
  std::string changed;  ///< for the caption: the parameters that differ from their defaults
  std::string
      object_name;  ///< for the caption; empty: left out (PlotContacts and PlotScene know it)
};

/// Figure 2 for one run: manipulability phi of the exploring finger (noise-free bold, as sensed
/// light, other fingers thin), the stability measure with its threshold, the load margin rho, and
/// strips that show the state of the session and the criterion that is active. Events are numbered
/// marks.
void PlotQuality(std::span<const Frame> history, std::span<const Event> events,
                 const HandModel& hand, const PlotOptions& options, const std::string& path);
Pixels QualityPixels(std::span<const Frame> history, std::span<const Event> events,
                     const HandModel& hand, const PlotOptions& options);

/// One run of a comparison.
struct LabelledRun {
  std::string label;              ///< for the legend, e.g. "manipulability"
  std::span<const Frame> frames;  ///< the part before the exploration is cut off
  std::string object_name;        ///< as in PlotOptions, of this run
  std::string changed;
};

/// Figure 2 of the paper: explorations that start from the same state, one curve each:
/// manipulability of the exploring finger above, stability of the grasp below. Time counts from the
/// first frame that explores (from the first frame of a run that never does). The line of facts
/// says what is common to the runs, then what is each one's own.
void PlotQualityComparison(std::span<const LabelledRun> runs, const HandModel& hand,
                           const PlotOptions& options, const std::string& path);

/// Figure 3a: the contact points as sensed, in the object's own frame as sensed, one colour per
/// finger, in a perspective view and two orthogonal views [mm], with the object's outline. With
/// `felt`, the perspective view shows the felt surface where it is known, its distance from the
/// true one as colour; without, or for a sphere, the least-squares sphere through the points.
void PlotContacts(std::span<const Frame> history, const HandModel& hand, const ObjectModel& object,
                  const PlotOptions& options, const std::string& path,
                  const FeltSurface* felt = nullptr);

/// Figure 1: hand, object, contacts and contact forces of one frame (the truth), seen from two
/// sides.
void PlotScene(const Frame& frame, const HandModel& hand, const ObjectModel& object,
               const PlotOptions& options, const std::string& path);
Pixels ScenePixels(const Frame& frame, const HandModel& hand, const ObjectModel& object,
                   const PlotOptions& options);

/// Figure 3b: the finger gait over time: the state of the gait by the paper's names, the role of
/// every finger, the object's angle (reference and achieved), manipulability of the finger that
/// explores, stability of the grasp. What does not occur in the history (no rotation, no
/// exploration) is left out.
void PlotGait(std::span<const Frame> history, std::span<const Event> events, const HandModel& hand,
              const PlotOptions& options, const std::string& path);

/// What the picture of a drop shows beside the frames.
struct IncidentNote {
  /// A finger that no longer touched the object at the end.
  struct ContactEnd {
    int finger = -1;
    double time_s = 0;    ///< of its last touch
    bool lifted = false;  ///< the gait had taken it off
  };
  std::int64_t tick = 0;
  double time_s = 0;             ///< of the drop
  std::string cause;             ///< the title
  double margin_limit = 0;       ///< load margin that a finger must leave behind [N]
  double drop_distance = 0;      ///< object error that counts as dropped [m]
  std::vector<ContactEnd> ends;  ///< in order of time
};

/// The time before a drop: what the session and the gait did, which finger touched the object in
/// which role, the noise-free normal force of every finger, the load margin rho as sensed and the
/// object's distance from its reference. Time counts back from the drop. Pushes, changes of
/// parameters and the first lost contact are labelled. `frames` end at the drop.
void PlotIncident(std::span<const Frame> frames, std::span<const Event> events,
                  const IncidentNote& note, const HandModel& hand, const PlotOptions& options,
                  const std::string& path);

}  // namespace regrasp
