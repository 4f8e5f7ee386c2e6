#pragma once

namespace regrasp {

/// Constants of the surface that fingers feel: what counts as felt, and how it is interpolated
/// (felt_surface.h has the equation). Unit, range and source of each stand in the parameter table
/// (core/session/parameters.cc).
struct ShapeParameters {
  // What counts.
  double interval_s = 0.005;      ///< from one look at a finger to the next
  double settled_s = 0.040;       ///< in contact for so long, the contact filters have followed
  double least_force = 0.1;       ///< [N]
  double least_cosine = 0.15;     ///< n . u of a contact that can be on a star-shaped body
  double default_radius = 0.025;  ///< before anything is felt [m]
  int full = 20;                  ///< samples that make a cell fully trusted
  int memory = 150;               ///< a cell is the mean of about so many last samples
  // Between what was felt.
  double near = 0.07;          ///< θ_0 [rad]
  double slope_reach2 = 0.18;  ///< θ_s²: so far a cell's slope is believed [rad²]
  double turn_reach2 = 0.05;   ///< farther from its cell a normal turns with the direction [rad²]
  double steepest = 1.2;       ///< |g_i| at most
  double prior_angle = 0.5;    ///< the mean counts as if felt this far away [rad]
  double bend_reach = 0.10;    ///< normals within about this are compared [rad]
};

}  // namespace regrasp
