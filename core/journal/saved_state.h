#pragma once

/// The whole state of a session as bytes, to go on from it at once: some ten kB that only the build
/// that wrote them can read. The journal remains the second way to the same state.

#include <string>
#include <string_view>

#include "core/common/fields.h"
#include "core/session/session.h"

namespace regrasp {

/// Empty once the simulation has faulted.
std::string SaveState(const Session& session);

/// Brings a session of the same configuration into that state; whatever it did before leaves no
/// trace. Every number is checked. Throws StateError that says what is wrong: another format,
/// build, hand, object or time step, a field that cannot be, a state that is not the one that was
/// saved. The session must be thrown away, or loaded again, then.
void LoadState(std::string_view state, Session* session);

/// Bytes as text, 64 signs, and back; throws StateError for what is no such text.
std::string ToBase64(std::string_view bytes);
std::string FromBase64(std::string_view text);

}  // namespace regrasp
