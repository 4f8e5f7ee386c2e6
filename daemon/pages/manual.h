#pragma once

/// Sources of the manual pages, for scdoc(1).

#include <string>

namespace regrasp {

/// regraspd(8): made from the table of configuration keys (`regraspd --print-manual`).
std::string DaemonManual();

/// regrasp-protocol(7): the protocol page in another dress (`regraspd --print-protocol-manual`).
std::string ProtocolManual();

}  // namespace regrasp
