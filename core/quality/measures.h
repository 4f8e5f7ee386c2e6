#pragma once

/// Every measure of grasp stability, as one table: what selects a measure, shows it, writes it or
/// asks for it by name follows from here. A new one is an entry of Measure, a row of kMeasureTable
/// and its function in measures.cc.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/common/info_table.h"
#include "core/quality/grasp.h"
#include "core/quality/stability.h"

namespace regrasp {

/// In the order of the table; those that are never in a frame come last.
enum class Measure : std::uint8_t { kMinSingularValue, kEpsilon, kSqrtDet, kIsotropy, kVolume };

/// How dear a measure is, which decides who may ask for it.
enum class MeasureCost : std::uint8_t {
  kTick,       ///< microseconds, no allocation: of the present tick, exploration may maximise it
  kSpread,     ///< spread over ticks by the quality monitor: in every frame, but of the recent past
  kOnRequest,  ///< about a millisecond, allocates: outside the simulation only
};

/// A grasp to be measured. What several measures share is computed once.
class MeasureInput {
 public:
  /// contacts: positions relative to the centre about which moments are taken. torque_scale [m], >
  /// 0. cone_edges: of the friction pyramid, where a measure takes one. The contacts must outlive
  /// this.
  MeasureInput(std::span<const GraspContact> contacts, double torque_scale, int cone_edges)
      : contacts_(contacts), torque_scale_(torque_scale), cone_edges_(cone_edges) {}
  std::span<const GraspContact> contacts() const { return contacts_; }
  double torque_scale() const { return torque_scale_; }
  int cone_edges() const { return cone_edges_; }
  const SingularMeasures& singular() {
    if (!singular_) singular_ = ComputeSingularMeasures(contacts_, torque_scale_);
    return *singular_;
  }

 private:
  std::span<const GraspContact> contacts_;
  double torque_scale_;
  int cone_edges_;
  std::optional<SingularMeasures> singular_;
};

struct MeasureInfo {
  Measure id;
  std::string_view name;   ///< on the wire, in files and on the command line
  std::string_view label;  ///< on the axis of a plot
  std::string_view unit;   ///< "" when dimensionless
  std::string_view meaning;
  MeasureCost cost;
  double (*compute)(MeasureInput&);
};

// What the rows compute; each is explained where its mathematics is.
double MinSingularValueOf(MeasureInput& input);  ///< core/quality/stability.h
double EpsilonOf(MeasureInput& input);           ///< core/quality/epsilon.h
double SqrtDetOf(MeasureInput& input);           ///< core/quality/stability.h
double IsotropyOf(MeasureInput& input);          ///< core/quality/stability.h
double VolumeOf(MeasureInput& input);            ///< core/quality/epsilon.h

// clang-format off
inline constexpr auto kMeasureTable = std::to_array<MeasureInfo>({
  {Measure::kMinSingularValue, "min_singular_value", "σ\u2098\u1d62\u2099(G)", "", "smallest singular value of the grasp matrix", MeasureCost::kTick, MinSingularValueOf},
  {Measure::kEpsilon, "epsilon", "ε (Ferrari\u2013Canny)", "", "largest ball of wrenches that the grasp resists", MeasureCost::kSpread, EpsilonOf},
  {Measure::kSqrtDet, "sqrt_det", "√det(G Gᵀ)", "", "product of the singular values of the grasp matrix", MeasureCost::kTick, SqrtDetOf},
  {Measure::kIsotropy, "isotropy", "σ\u2098\u1d62\u2099/σ\u2098\u2090\u2093", "", "smallest by largest singular value of the grasp matrix", MeasureCost::kTick, IsotropyOf},
  {Measure::kVolume, "volume", "volume of the wrench hull", "", "volume of the wrenches that the grasp resists", MeasureCost::kOnRequest, VolumeOf},
});
// clang-format on

inline constexpr std::size_t kNumMeasures = kMeasureTable.size();
/// How many a frame carries: the first rows.
inline constexpr std::size_t kNumFrameMeasures = static_cast<std::size_t>(std::ranges::count_if(
    kMeasureTable, [](const MeasureInfo& m) { return m.cost != MeasureCost::kOnRequest; }));
static_assert(InOrder(kMeasureTable));
static_assert([] {
  for (std::size_t i = 0; i < kNumMeasures; ++i)
    if ((kMeasureTable[i].cost == MeasureCost::kOnRequest) != (i >= kNumFrameMeasures))
      return false;
  return true;
}());

inline constexpr int kMonitorEdges = 8;  ///< of the friction pyramid while the hand is at work

constexpr const MeasureInfo& InfoOf(Measure measure) {
  return kMeasureTable[static_cast<std::size_t>(measure)];
}

/// Names of the measures that a frame carries: what control.stability_measure may be.
inline constexpr auto kFrameMeasureNames = NamesOf<kNumFrameMeasures>(kMeasureTable);

}  // namespace regrasp
