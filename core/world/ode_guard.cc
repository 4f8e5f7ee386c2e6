#include "core/world/ode_guard.h"

#include <ode/ode.h>

#include <cstdarg>
#include <cstdio>
#include <mutex>

namespace regrasp {
namespace {

[[noreturn]] void Throw(int number, const char* format, va_list arguments) {
  char text[200];
  std::vsnprintf(text, sizeof(text), format, arguments);
  char full[256];
  std::snprintf(full, sizeof(full), "ODE error %d: %s", number, text);
  throw OdeError(full);
}

}  // namespace

OdeError::OdeError(const char* text) { std::snprintf(text_, sizeof(text_), "%s", text); }

void EnsureOde() {
  static std::once_flag once;
  std::call_once(once, [] {
    dSetErrorHandler(Throw);
    dSetDebugHandler(Throw);
    dSetMessageHandler(Throw);
    dInitODE2(0);
  });
  thread_local const bool ready = dAllocateODEDataForThread(dAllocateMaskAll) != 0;
  if (!ready) throw OdeError("ODE could not allocate its data for this thread");
}

}  // namespace regrasp
