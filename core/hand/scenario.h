#pragma once

/// A scenario: which hand, which object, where they start. Read from TOML; everything that is
/// specific to one hand and is not in its URDF stands here.

#include <filesystem>
#include <string>
#include <vector>

#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/hand/hand_model.h"
#include "core/hand/model_error.h"
#include "core/hand/model_path.h"
#include "core/hand/model_report.h"
#include "core/hand/object_model.h"

namespace regrasp {

struct Scenario {
  std::string name;
  std::string hand;        ///< name of the hand model
  std::string object;      ///< name of the default object model
  JointVector q_preshape;  ///< open hand from which `grasp` closes [rad]
  JointVector q_closed;    ///< `grasp` moves joints from q_preshape towards this [rad]
  Isometry3d X_WO = Isometry3d::Identity();    ///< where the stand-in presents the object
  Vector3d gravity_W = Vector3d(0, 0, -9.81);  ///< [m/s²]
};

/// The files of a hand given by name, by its URDF or by its scenario: the scenario stands beside
/// the URDF under the same name, or names the URDF itself (`urdf`, relative to the scenario's
/// place). `scenario` is empty where there is none. Throws ModelError.
struct HandFiles {
  std::filesystem::path urdf, scenario;
};
HandFiles FindHandFiles(const std::string& hand,
                        const std::vector<std::filesystem::path>& search_path);

struct LoadedScenario {
  Scenario scenario;
  HandModel hand;
  ObjectModel object;
  ModelReport report;  ///< what loading did beyond reading; not part of a run
};

/// Loads the scenario that belongs to a hand (`hand`: a name in the search path, a .urdf file with
/// a .toml of the same name beside it, or a .toml file; HandFiles) with an object (a name, a .urdf
/// file, or empty for the scenario's own). Throws ModelError; a name that is not found is answered
/// with the names that are.
LoadedScenario LoadScenario(const std::string& hand, const std::string& object,
                            const std::vector<std::filesystem::path>& search_path,
                            const LoadOptions& options = {});

/// Loads one object by name or .urdf file. Throws ModelError.
ObjectModel LoadObject(const std::string& object,
                       const std::vector<std::filesystem::path>& search_path,
                       const LoadOptions& options = {}, ModelReport* report = nullptr);

/// Names of the objects in the search path, sorted.
std::vector<std::string> ListObjects(const std::vector<std::filesystem::path>& search_path);

}  // namespace regrasp
