#include "core/protocol/standard_files.h"

#include <fcntl.h>
#include <unistd.h>

namespace regrasp {

void OccupyStandardFiles() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (::fcntl(fd, F_GETFD) >= 0) continue;
    // The lowest free number is `fd`; the wrong direction, so that using it is an error.
    ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

}  // namespace regrasp
