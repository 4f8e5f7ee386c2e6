#pragma once

/// The ground truth of an exploration: what the best contact within reach would have been worth.

#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

struct PhiMap {
  double best = 0;        ///< largest noise-free phi on any ray
  double distance_m = 0;  ///< of that contact from where the rays begin
  int rays = 0;           ///< that could be slid along
  Json samples;           ///< [{ray, p_WC_m[3], phi}], every 50 ticks
};

/// The name of what a criterion maximises in what `truth` tells of a finger; "" where it does not.
std::string TruthNameOf(const std::string& criterion);

/// Slides `finger` from the state in which it holds the object along `rays` rays, spread evenly
/// over all tangent directions, with sensor noise off, and records the noise-free objective on the
/// way.
///
/// The slide is Algorithm 1 itself with a gradient that is never updated: the start gradient is the
/// ray, its seed is chosen for its direction, and excursion bound, joint limits and other fingers
/// stop or turn it exactly as they do an exploration. What the rays meet is therefore what an
/// exploration could reach. Only the slide from the side of a link onto its round tip
/// (exploration.onto_tip_s) is left out: a ray would get stuck where an exploration may. So one
/// that does slide there may end above the map's best.
///
/// The daemon is put back to the state before exploring for each ray, that of a grasp of run `seed`
/// at noise `noise`. Parameters and noise are as before afterwards, the run is not.
/// `exploration.sigma` must be positive.
PhiMap MapPhi(SteppedDaemon* daemon, const std::string& noise, std::int64_t seed,
              const std::string& finger, const std::string& criterion, int rays);

}  // namespace regrasp::cli
