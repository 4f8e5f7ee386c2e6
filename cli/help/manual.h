#pragma once

#include <string>

namespace regrasp::cli {

/// The source of regrasp(1), for scdoc(1), made from the commands (`regrasp help --manual`).
std::string ManualSource();

}  // namespace regrasp::cli
