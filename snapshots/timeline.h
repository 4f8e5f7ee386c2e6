#pragma once

/// What the pictures over time share: the part of the history that is shown, the strips of states
/// and criteria, event marks, and the line of facts. Internal to snapshots/.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/session/frame.h"
#include "snapshots/axes.h"
#include "snapshots/snapshots.h"

namespace regrasp {

/// The frames of the newest `last_s` seconds (0: all) since time last went back (a reset). Throws
/// std::runtime_error naming `path` when there are none.
std::span<const Frame> Newest(std::span<const Frame> history, double last_s,
                              const std::string& path);

/// The same with what `options` know.
std::string Facts(std::span<const Frame> frames, const HandModel& hand, const PlotOptions& options);

/// The time axis of these frames; a start within 0.1 s of a whole second is moved there.
Axis TimeAxis(std::span<const Frame> frames, const Canvas& canvas);

/// "seed 1 · noise paper · hand shadow · object sphere (80 g, µ 0.8) · simulated time 12 to 40 s":
/// what a reader needs to repeat it.
std::string Facts(std::span<const Frame> frames, const HandModel& hand, const std::string& object,
                  const std::string& changed);

/// The same one by one: every run has as many, in the same order.
std::vector<std::string> FactList(std::span<const Frame> frames, const HandModel& hand,
                                  const std::string& object, const std::string& changed);

std::string FingerName(const HandModel& hand, int finger);

/// A stretch of time in which something kept its value.
struct Band {
  double begin_s = 0, end_s = 0;
  int value = 0;
};
/// Runs of equal value(frame); a run ends where the next begins. Values below 0 leave a gap.
std::vector<Band> Bands(std::span<const Frame> frames,
                        const std::function<int(const Frame&)>& value);

struct BandLook {
  std::string label;
  Colour colour;
  std::string short_label = {};  ///< where `label` does not fit
};
/// A strip of labelled bands aligned with `panel`, from y to y + height. A label that does not fit
/// its band is left out; `name` stands left of the strip.
void DrawStrip(Canvas* canvas, const Panel& panel, double y, double height, const std::string& name,
               std::span<const Band> bands, const std::function<BandLook(int)>& look);
/// Paints the states, paler than in the strip, behind a panel.
void DrawStateBackground(Canvas* canvas, const Panel& panel, std::span<const Band> states);

/// Marks the events that explain a curve (contacts, pushes, faults, parameters, ...) in a row at y,
/// with a thin line through each panel.
void DrawEvents(Canvas* canvas, std::span<const Panel> panels, double y,
                std::span<const Frame> frames, std::span<const Event> events);
/// The legend of the kinds that occur.
std::vector<LegendEntry> EventLegend(std::span<const Frame> frames, std::span<const Event> events);

}  // namespace regrasp
