#include "core/quality/measures.h"

#include "core/quality/epsilon.h"

namespace regrasp {

double MinSingularValueOf(MeasureInput& input) { return input.singular().min_singular_value; }

double SqrtDetOf(MeasureInput& input) { return input.singular().sqrt_det; }

double IsotropyOf(MeasureInput& input) { return input.singular().isotropy; }

double EpsilonOf(MeasureInput& input) {
  EpsilonSolver solver;
  return solver.Compute(input.contacts(), input.torque_scale(), input.cone_edges());
}

double VolumeOf(MeasureInput& input) {
  return WrenchHullVolume(input.contacts(), input.torque_scale(), input.cone_edges());
}

}  // namespace regrasp
