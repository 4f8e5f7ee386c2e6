#pragma once

/// Where models are looked for.

#include <filesystem>
#include <string>
#include <vector>

#include "core/hand/model_error.h"

namespace regrasp {

/// Directories that are searched for models, in order: `models_dir` if given, $REGRASP_MODELS_DIR,
/// share/regrasp/models beside the program's bin/, the source tree this was built from, the share/
/// it was configured for. Throws ModelError where one of the first two is no directory.
std::vector<std::filesystem::path> ModelSearchPath(const std::string& models_dir = "");

/// The URDF file of a model given by name or as a file. `kind`: "hands" or "objects". Throws
/// ModelError; a name that is not found is answered with the names that are.
std::filesystem::path FindModel(const std::string& name, const char* kind,
                                const std::vector<std::filesystem::path>& search_path);

/// Names of the models of a kind in the search path, sorted.
std::vector<std::string> ListModels(const std::vector<std::filesystem::path>& search_path,
                                    const char* kind);

}  // namespace regrasp
