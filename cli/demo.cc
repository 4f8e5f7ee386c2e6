#include "cli/demo.h"
namespace regrasp::cli { ExitCode Demo(Context&, const Invocation&) { return kOk; } }
