#include "core/quality/evaluate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "core/quality/epsilon.h"
#include "core/quality/load_margin.h"

namespace regrasp {
namespace {

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

constexpr double kUnitTolerance = 1e-3;

/// Judges numbers one by one and keeps what is wrong with them.
struct Judge {
  std::vector<std::string> faults = {};

  bool InRange(const std::string& name, double value, double least, double most) {
    if (value >= least && value <= most) return true;  // false for NaN
    faults.push_back(name + ": " + Number(value) + "; allowed: " + Number(least) + " ... " +
                     Number(most));
    return false;
  }
  bool InRange(const std::string& name, const Vector3d& v, double most) {
    bool all = true;
    for (int k = 0; k < 3; ++k)
      all &= InRange(name + "[" + std::to_string(k) + "]", v(k), -most, most);
    return all;
  }
  void Contact(const EvaluateNames::Contact& names, const GraspContact& contact) {
    InRange(names.position, contact.position, 10.0);
    const double length = contact.inward_normal.norm();
    if (InRange(names.normal, contact.inward_normal, 1.0 + kUnitTolerance) &&
        std::abs(length - 1.0) > kUnitTolerance)
      faults.push_back(names.normal + ": length " + Number(length) +
                       "; allowed: a unit vector (within 0.001)");
    InRange(names.mu, contact.mu, 0.0, 10.0);
    InRange(names.torsion, contact.torsion, 0.0, 10.0);
  }
};

}  // namespace

std::vector<std::string> Faults(const EvaluateInput& input, const EvaluateNames& names) {
  Judge judge;
  if (input.contacts.empty()) judge.faults.emplace_back("contacts: none; allowed: at least 1");
  for (std::size_t i = 0; i < input.contacts.size(); ++i) {
    const std::string prefix = "contacts[" + std::to_string(i) + "].";
    const EvaluateNames::Contact usual = {prefix + "position_m", prefix + "normal", prefix + "mu",
                                          prefix + "torsional_mu"};
    judge.Contact(i < names.contacts.size() ? names.contacts[i] : usual, input.contacts[i]);
  }
  judge.InRange(names.torque_scale, input.torque_scale, 1e-4, 10.0);
  if (judge.InRange("cone_edges", input.cone_edges, 3, 1024)) {
    const std::size_t wrenches = input.contacts.size() * static_cast<std::size_t>(input.cone_edges);
    if (wrenches > kMaxEvaluateWrenches)
      judge.faults.push_back("contacts * cone_edges: " + std::to_string(wrenches) +
                             "; allowed: at most " + std::to_string(kMaxEvaluateWrenches));
  }
  if (input.weight) judge.InRange("weight_n", *input.weight, 1e6);
  if (!(input.max_force > 0.0))
    judge.faults.push_back("max_force_n: " + Number(input.max_force) + "; allowed: above 0");
  return judge.faults;
}

bool NormalsPointAway(const EvaluateInput& input) {
  return !input.contacts.empty() && std::ranges::all_of(input.contacts, [](const auto& contact) {
    return contact.inward_normal.dot(contact.position) > 0;
  });
}

EvaluateOutput Evaluate(const EvaluateInput& input) {
  if (const std::vector<std::string> faults = Faults(input); !faults.empty())
    throw std::invalid_argument(faults.front());
  std::vector<GraspContact> contacts = input.contacts;
  for (GraspContact& contact : contacts) contact.inward_normal.normalize();

  EvaluateOutput out;
  MeasureInput measured(contacts, input.torque_scale, input.cone_edges);
  const bool large =
      contacts.size() * static_cast<std::size_t>(input.cone_edges + 2) > kMaxHullWrenches;
  for (const MeasureInfo& info : kMeasureTable)
    if (!large || info.cost != MeasureCost::kOnRequest)
      out.values[static_cast<std::size_t>(info.id)] = info.compute(measured);
  out.force_closure = *out.of(Measure::kEpsilon) > 0.0;
  if (input.weight)
    out.load_margin = LoadMargin(contacts, *input.weight, input.torque_scale, input.max_force);
  return out;
}

}  // namespace regrasp
