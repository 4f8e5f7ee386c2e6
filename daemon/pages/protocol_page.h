#pragma once

#include <string>

namespace regrasp {

/// docs/protocol.md, made from the method table (`regraspd --print-protocol`).
std::string ProtocolPage();

}  // namespace regrasp
