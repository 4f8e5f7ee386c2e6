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

void RequireRange(const std::string& name, double value, double least, double most) {
  if (value >= least && value <= most) return;  // false for NaN
  throw std::invalid_argument(name + ": " + Number(value) + "; allowed: " + Number(least) +
                              " ... " + Number(most));
}

void RequireRange(const std::string& name, const Vector3d& v, double most) {
  for (int k = 0; k < 3; ++k) RequireRange(name + "[" + std::to_string(k) + "]", v(k), -most, most);
}

constexpr double kUnitTolerance = 1e-3;

void Validate(const EvaluateInput& input) {
  if (input.contacts.empty()) throw std::invalid_argument("contacts: none; allowed: at least 1");
  for (std::size_t i = 0; i < input.contacts.size(); ++i) {
    const GraspContact& contact = input.contacts[i];
    const std::string name = "contacts[" + std::to_string(i) + "].";
    RequireRange(name + "position_m", contact.position, 10.0);
    RequireRange(name + "normal", contact.inward_normal, 1.0 + kUnitTolerance);
    const double length = contact.inward_normal.norm();
    if (std::abs(length - 1.0) > kUnitTolerance)
      throw std::invalid_argument(name + "normal: length " + Number(length) +
                                  "; allowed: a unit vector (within 0.001)");
    RequireRange(name + "mu", contact.mu, 0.0, 10.0);
    RequireRange(name + "torsional_mu", contact.torsion, 0.0, 10.0);
  }
  RequireRange("torque_scale_m", input.torque_scale, 1e-4, 10.0);
  RequireRange("cone_edges", input.cone_edges, 3, 1024);
  const std::size_t wrenches = input.contacts.size() * static_cast<std::size_t>(input.cone_edges);
  if (wrenches > kMaxEvaluateWrenches)
    throw std::invalid_argument("contacts * cone_edges: " + std::to_string(wrenches) +
                                "; allowed: at most " + std::to_string(kMaxEvaluateWrenches));
  if (input.weight) RequireRange("weight_n", *input.weight, 1e6);
  if (!(input.max_force > 0.0))
    throw std::invalid_argument("max_force_n: " + Number(input.max_force) + "; allowed: above 0");
}

}  // namespace

bool NormalsPointAway(const EvaluateInput& input) {
  return !input.contacts.empty() && std::ranges::all_of(input.contacts, [](const auto& contact) {
    return contact.inward_normal.dot(contact.position) > 0;
  });
}

EvaluateOutput Evaluate(const EvaluateInput& input) {
  Validate(input);
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
