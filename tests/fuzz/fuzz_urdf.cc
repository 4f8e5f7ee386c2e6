// A URDF file as hand and as object: refused with a ModelError, or loaded with sane numbers. Mesh
// files named in it are not there.
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_urdf && build/fuzz/tests/fuzz_urdf
//   -max_len=16384 tests/fuzz/corpus/urdf

#include <cmath>

#include "core/hand/kinematics.h"
#include "core/hand/urdf.h"
#include "tests/fuzz/model_file.h"

namespace {

using namespace regrasp;

void Require(bool condition) {
  if (!condition) std::abort();
}

void TryHand(const std::filesystem::path& path, const LoadOptions& options) {
  HandLayout layout;
  layout.fingers = {{"only", "tip"}};
  ModelReport report;
  const HandModel hand = LoadHand(path, layout, options, &report);
  Require(hand.num_joints() > 0 && hand.joints.size() <= std::size_t{kMaxJoints});
  KinematicsData data;
  JointVector q(hand.num_joints());
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
    Require(joint.lower < joint.upper && joint.effort > 0 && joint.driver < 0);
    q[j] = joint.upper;
  }
  ForwardKinematics(hand, q, &data);
  Require(PointJacobian(hand, data, 0, FingertipCentre(hand, data, 0)).allFinite());
  Require(GravityTorque(hand, data, Vector3d(0, 0, -9.81)).allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static ModelFile file;
  file.Write(data, size);
  for (const bool lenient : {false, true}) {
    LoadOptions options;
    options.force = options.inertia_from_shape = options.fill_missing_meshes = lenient;
    try {
      TryHand(file.path(), options);
    } catch (const ModelError&) {
    }
    try {
      const ObjectModel object = LoadObjectUrdf(file.path(), options);
      Require(object.mass > 0 && object.bounding_radius <= 1 && object.I_OCom.allFinite());
    } catch (const ModelError&) {
    }
  }
  return 0;
}
