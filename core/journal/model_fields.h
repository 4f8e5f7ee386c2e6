#pragma once

/// The fields of everything a configuration holds. Internal to this folder.

#include "core/hand/scenario.h"
#include "core/journal/fields.h"
#include "core/session/parameters.h"

namespace regrasp {

template <typename A>
void Fields(A& a, NoiseLevels& n) {
  a("position_m", n.position_m);
  a("normal_rad", n.normal_rad);
  a("force_n", n.force_n);
  a("joint_rad", n.joint_rad);
  a("object_position_m", n.object_position_m);
  a("object_rotation_rad", n.object_rotation_rad);
  a("taxel_pitch_m", n.taxel_pitch_m);
  a("object_rate_hz", n.object_rate_hz);
  a("object_delay_frames", n.object_delay_frames);
}

template <typename A>
void Fields(A& a, WorldConfig& w) {
  a("dt_s", w.dt);
  a("stepper", w.stepper);
  a("iterations", w.iterations);
  a("contact_stiffness_n_m", w.contact_stiffness);
  a("contact_damping_n_s_m", w.contact_damping);
  a("over_relaxation", w.over_relaxation);
  a("joint_erp", w.joint_erp);
  a("joint_cfm", w.joint_cfm);
  a("warm_start", w.warm_start);
  a("contact_warm_start", w.contact_warm_start);
  a("merge_universal", w.merge_universal);
}

template <typename A>
void Fields(A& a, Shape& s) {
  a("kind", s.kind);
  a("a_L", s.a_L);
  a("b_L", s.b_L);
  a("radius", s.radius);
  a("X_LB", s.X_LB);
  a("half_extents", s.half_extents);
}

template <typename A>
void Fields(A& a, Link& l) {
  a("name", l.name);
  a("parent_joint", l.parent_joint);
  a("mass", l.mass);
  a("p_LCom", l.p_LCom);
  a("I_LCom", l.I_LCom);
  a("shapes", l.shapes);
}

template <typename A>
void Fields(A& a, Joint& j) {
  a("name", j.name);
  a("parent_link", j.parent_link);
  a("child_link", j.child_link);
  a("X_PJ", j.X_PJ);
  a("axis_J", j.axis_J);
  a("lower", j.lower);
  a("upper", j.upper);
  a("effort", j.effort);
  a("damping", j.damping);
  a("armature", j.armature);
}

template <typename A>
void Fields(A& a, Finger& f) {
  a("name", f.name);
  a("joints", f.joints);
  a("tip_link", f.tip_link);
  a("p_LF", f.p_LF);
  a("tip_radius", f.tip_radius);
}

template <typename A>
void Fields(A& a, HandModel& h) {
  a("name", h.name);
  a("links", h.links);
  a("joints", h.joints);
  a("fingers", h.fingers);
}

template <typename A>
void Fields(A& a, ObjectModel& o) {
  a("name", o.name);
  a("kind", o.kind);
  a("radius", o.radius);
  a("half_length", o.half_length);
  a("half_extents", o.half_extents);
  a("vertices_O", o.vertices_O);
  a("triangles", o.triangles);
  a("mass", o.mass);
  a("I_OCom", o.I_OCom);
  a("friction", o.friction);
  a("bounding_radius", o.bounding_radius);
}

template <typename A>
void Fields(A& a, Scenario& s) {
  a("name", s.name);
  a("hand", s.hand);
  a("object", s.object);
  a("q_preshape", s.q_preshape);
  a("q_closed", s.q_closed);
  a("X_WO", s.X_WO);
  a("gravity_W", s.gravity_W);
}

template <typename A>
void Fields(A& a, LoadedScenario& m) {
  a("scenario", m.scenario);
  a("hand", m.hand);
  a("object", m.object);
}

}  // namespace regrasp

namespace regrasp::fields {

/// Parameters go by the names of their table.
template <>
struct Value<Parameters> {
  static Json To(const Parameters& parameters) {
    Json json = Json::object();
    Parameters copy = parameters;
    for (const ParameterInfo& info : ParameterTable()) {
      const double* value = info.access(copy);
      json[std::string(info.name)] = std::vector<double>(value, value + info.size);
    }
    return json;
  }
  static void From(const Json& json, Parameters* parameters) {
    Load load{json};
    for (const ParameterInfo& info : ParameterTable()) {
      std::vector<double> value;
      load(std::string(info.name).c_str(), value);
      if (value.size() != static_cast<std::size_t>(info.size))
        throw JournalError(std::string(info.name) + " has the wrong number of numbers");
      std::copy(value.begin(), value.end(), info.access(*parameters));
    }
  }
};

}  // namespace regrasp::fields
