#include "build_identity.h"

#include "core/journal/journal.h"

namespace regrasp {

std::string_view BuildIdentity() {
  return REGRASP_VERSION " " REGRASP_COMMIT " gcc-" __VERSION__ " " REGRASP_FLAGS_HASH;
}

}  // namespace regrasp
