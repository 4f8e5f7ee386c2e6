#pragma once

/// The fields of everything a configuration holds. Internal to this folder.

#include <type_traits>

#include "core/hand/scenario.h"
#include "core/journal/fields.h"
#include "core/session/parameter_value.h"

namespace regrasp {

template <typename A>
void Fields(A& a, NoiseLevels& n) {
  n.Fields(a);
}

template <typename A>
void Fields(A& a, WorldConfig& w) {
  a("dt_s", w.dt);
  a("stepper", w.stepper);
  a("contact_max_sweeps", w.contact_solver.max_sweeps);
  a("contact_direct_solutions", w.contact_solver.direct_solutions);
  a("contact_tolerance_n", w.contact_solver.tolerance);
  a("contact_stiffness_n_m", w.contact_stiffness);
  a("contact_damping_n_s_m", w.contact_damping);
  a("joint_erp", w.joint_erp);
  a("joint_cfm", w.joint_cfm);
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
  a("driver", j.driver);
  a("ratio", j.ratio);
  a("offset", j.offset);
}

template <typename A>
void Fields(A& a, Finger& f) {
  a("name", f.name);
  a("joints", f.joints);
  a("tip_link", f.tip_link);
  a("p_LF", f.p_LF);
  a("tip_radius", f.tip_radius);
  if constexpr (std::is_same_v<A, fields::Load>) {  // told where it is not 1
    if (a.json.contains("tip_shapes")) a("tip_shapes", f.tip_shapes);
  } else if (f.tip_shapes != 1) {
    a("tip_shapes", f.tip_shapes);
  }
}

template <typename A>
void Fields(A& a, HandModel& h) {
  a("name", h.name);
  a("links", h.links);
  a("joints", h.joints);
  a("num_coupled", h.num_coupled);
  a("fingers", h.fingers);
}

template <typename A>
void Fields(A& a, ObjectModel& o) {
  a("name", o.name);
  a("kind", o.kind);
  a("radius", o.radius);
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

/// Words and booleans as themselves, numbers as a list of one or three.
inline Json ParameterJson(const ParameterInfo& info, const Vector3d& value) {
  if (info.type == ParameterType::kWord) return ParameterText(info, value);
  if (info.type == ParameterType::kBoolean) return value.x() != 0;
  return std::vector<double>(value.data(), value.data() + info.size());
}

/// Throws JournalError. Numbers are not held to their range: a model's mass may lie outside.
inline Vector3d ReadParameter(const ParameterInfo& info, const Json& json) {
  try {
    if (json.is_boolean()) return ReadParameterValue(info, json.get<bool>());
    if (json.is_string()) return ReadParameterValue(info, json.get<std::string>());
    const auto numbers = json.get<std::vector<double>>();
    if (numbers.size() != static_cast<std::size_t>(info.size()))
      throw JournalError(std::string(info.name) + " has the wrong number of numbers");
    // Former versions wrote words and booleans as lists of one number too.
    if (info.type == ParameterType::kWord || info.type == ParameterType::kBoolean)
      return ReadParameterValue(info, numbers.front());
    Vector3d value = Vector3d::Zero();
    std::copy(numbers.begin(), numbers.end(), value.data());
    return value;
  } catch (const ParameterError& e) {
    throw JournalError(e.what());
  } catch (const nlohmann::json::exception&) {
    throw JournalError(std::string(info.name) + " is of another kind than expected");
  }
}

/// Parameters go by the names of their table.
template <>
struct Value<Parameters> {
  static Json To(const Parameters& parameters) {
    Json json = Json::object();
    for (const ParameterInfo& info : ParameterTable())
      json[std::string(info.name)] = ParameterJson(info, info.get(parameters));
    return json;
  }
  static void From(const Json& json, Parameters* parameters) {
    for (const ParameterInfo& info : ParameterTable()) {
      const auto found = json.find(info.name);
      if (found == json.end()) throw JournalError(std::string(info.name) + " is missing");
      info.set(parameters, ReadParameter(info, *found));
    }
  }
};

}  // namespace regrasp::fields
