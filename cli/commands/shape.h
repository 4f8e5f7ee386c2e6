#pragma once

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// `shape`: what the fingers have felt of the object, in figures or as a mesh.
CommandSpec ShapeCommand();

}  // namespace regrasp::cli
