#pragma once

namespace regrasp {

/// Call first in main(). Where a program is started with standard input, output or error closed,
/// the next files that it opens, its sockets for instance, would take their numbers, and what is
/// printed would go there. Afterwards the numbers are taken: reading and writing through them
/// fails, as it did, and nothing else does.
void OccupyStandardFiles();

}  // namespace regrasp
