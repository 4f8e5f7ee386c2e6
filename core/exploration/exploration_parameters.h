#pragma once

#include "core/common/frames.h"
#include "core/exploration/estimator.h"

namespace regrasp {

/// Constants of Algorithm 1. lambda and sigma are the paper's; the paper gives no number for the
/// others. Unit, range and source of each stand in the parameter table
/// (core/session/parameters.cc).
struct ExplorationParameters {
  double sigma = 0.15;  ///< line 2: start gradient, standard deviation per axis, times gradient_max
  double lambda = 0.9;  ///< line 8: sliding mean
  double epsilon = 4.0;            ///< line 3: the gradient norm that counts as converged [1/m]
  int converged_updates = 10;      ///< line 3: for so many consecutive updates
  int max_cycles = 8000;           ///< line 3: N_max [ticks]
  int update_cycles = 25;          ///< line 4: n [ticks]
  double min_displacement = 3e-4;  ///< an update waits until the contact has moved so far [m]
  double gradient_max = 60;        ///< line 7: cap of the gradient norm [1/m]
  double eta = 1e-3;               ///< line 11: speed per gradient [m²/s]
  double speed_min = 0.006;        ///< [m/s]
  double speed_max = 0.015;        ///< [m/s]
  double normal_force = 0.4;       ///< of the exploring finger [N]
  double max_excursion = 0.008;    ///< from where it started [m]
  double limit_margin = 0.04;      ///< a joint this near to its limit is a wall [rad]
  double least_facing =
      -0.05;  ///< link axis . outward normal: above it the contact nears the side of the tip
  double onto_tip_s = 3.0;  ///< so long at most to slide from the side of a link onto its round tip
  double clearance = 0.002;     ///< a link of another finger, or the rest of the last link and the
                                ///< object, this near are walls [m]
  double wall_return = 5.0;     ///< speed back from behind a wall, per depth [1/s]
  double dither_speed = 0.008;  ///< least_squares: circular dither [m/s]
  double dither_hz = 3.0;       ///< least_squares: its frequency
  double forgetting = 0.80;     ///< least_squares: weight of the past per update
  double stability_weight = 1.0;              ///< combined: weight of stability in the linear sum
  Vector3d turn_axis_W = -Vector3d::UnitZ();  ///< reserve: axis of the coming turn, sense included
  double reserve_manipulability = 0.1;  ///< reserve: rad per manipulability that count with it
  double reserve_margin_wanted = 0.4;   ///< reserve: load margin below which it counts less [N] ...
  double reserve_margin_cost = 1.0;     ///< ... by so much [rad/N]
  double transfer_s =
      0.25;  ///< load transfer before the finger starts to slide, and after it ends [s]
  // The slide around Algorithm 1 (guided_slide.h); what differs within a gait is a gait parameter.
  double settle_s = 0.15;       ///< rest after load transfer, until the filters follow
  double force_share = 0.5;     ///< normal force per load margin without the finger ...
  double least_force = 0.5;     ///< ... from this share of normal_force up to all of it
  double lost_contact_s = 0.3;  ///< contact is lost after so long without a reading of it
  double object_slow = 0.002;   ///< the finger slows down beyond this error of the object [m] ...
  double object_stop = 0.003;   ///< ... waits beyond this one [m] ...
  double object_wait_s = 0.3;   ///< ... and gives up after so long
  int tries = 3;                ///< of Algorithm 1, while N_max allows it and
  double little_gain = 1.02;    ///< ... the best phi is below so much of the first one
  double best_filter_s = 0.15;  ///< low pass on phi and contact point before they count as best
  double worth_returning = 1.002;  ///< a best phi of so much of the last one is returned to
  double no_gain_s = 2.0;          ///< the search ends after so long without such a gain; 0: never
  double return_gain = 8.0;        ///< of the way back: speed per distance [1/s]
  double arrived = 0.0002;         ///< ... which ends this near [m]
  double return_limit_s = 2.5;     ///< ... or after so long
  double disc_slack = 0.0005;      ///< a best contact may be so far beyond the gait's disc [m]
  double reload_limit_s = 1.0;     ///< no surface to stand on after so long without contact
};

/// N_max: the one asked for, or the parameter's where that is 0.
inline int MaxCycles(int asked, const ExplorationParameters& parameters) {
  return asked > 0 ? asked : parameters.max_cycles;
}

}  // namespace regrasp
