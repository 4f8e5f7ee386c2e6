#include "cli/demo/gait_record.h"

#include <Eigen/Geometry>

#include "cli/print/print.h"
#include "core/exploration/criterion.h"
#include "snapshots/sphere_fit.h"

namespace regrasp::cli {
namespace {

Eigen::Vector3d Vector3(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace

void GaitRecord::Look(SteppedDaemon* daemon) {
  const Json quality = daemon->Call("quality", {{"measures", "frame"}}),
             contacts = daemon->Call("contacts");
  if (quality.at("stability").is_number()) {
    stability_sum_ += quality["stability"].get<double>();
    ++stability_samples_;
  }
  if (const Json& exploration = quality.at("exploration"); exploration.is_object()) {
    std::string objective = Plain(exploration.at("criterion"));
    const CriterionInfo* const row = FindCriterion(objective);
    if (row) objective = Name(ActiveOf(row->id, false));
    const bool stability = row && row->phi_of == PhiOf::kStability;
    ++objective_[Plain(exploration.at("finger"))][objective];
    const Json& phi = exploration.at("phi");  // null: not known yet
    if (stability && phi.is_number() && phi.get<double>() > 0) {
      without_next_sum_ += phi.get<double>();
      ++without_next_samples_;
    }
  }
  const Json& object = contacts.at("object");
  const Json& q = object.at("q_WO_wxyz");
  const Eigen::Quaterniond q_WO(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(),
                                q.at(3).get<double>());
  const Eigen::Vector3d p_WO = Vector3(object.at("p_WO_m"));
  for (const auto& [finger, contact] : contacts.at("fingers").items())
    if (contact.at("p_WC_m").is_array())
      p_OC_.push_back(q_WO.conjugate() * (Vector3(contact.at("p_WC_m")) - p_WO));
}

Json GaitRecord::ToJson() const {
  Json objective = Json::object();
  for (const auto& [finger, samples] : objective_) objective[finger] = samples;
  const auto mean = [](double sum, int n) { return n > 0 ? Json(sum / n) : Json(); };
  Json sphere;
  if (const auto fit = FitSphere(p_OC_))
    sphere = {{"radius_m", fit->radius}, {"rms_error_m", fit->rms_error}};
  return {{"objective", objective},
          {"stability_mean", mean(stability_sum_, stability_samples_)},
          {"stability_without_next_mean", mean(without_next_sum_, without_next_samples_)},
          {"contact_points", p_OC_.size()},
          {"sphere", sphere}};
}

}  // namespace regrasp::cli
