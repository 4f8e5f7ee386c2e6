#include "core/journal/saved_state.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/journal/journal.h"

namespace regrasp {
namespace {

constexpr char kFormat[] = "regrasp-state";
constexpr std::uint32_t kVersion = 2;

/// What comes before the fields.
struct Head {
  char format[16] = {};
  std::uint32_t version = 0;
  char build[128] = {};
  char hand[64] = {}, object[64] = {};
  double dt = 0;
  std::uint64_t state_hash = 0;

  template <typename V>
  void Fields(V& v) {
    v("format", format);
    v("version", version);
    v("build", build);
    v("hand", hand);
    v("object", object);
    v("dt", dt);
    v("state_hash", state_hash);
  }
};

template <std::size_t n>
void Copy(std::string_view text, char (&target)[n]) {
  std::snprintf(target, n, "%.*s", static_cast<int>(text.size()), text.data());
}

Head MakeHead(const SessionConfig& config, std::uint64_t state_hash) {
  Head head;
  Copy(kFormat, head.format);
  head.version = kVersion;
  Copy(BuildIdentity(), head.build);
  Copy(config.model.hand.name, head.hand);
  Copy(config.model.object.name, head.object);
  head.dt = config.world.dt;
  head.state_hash = state_hash;
  return head;
}

void Expect(const char* what, std::string_view found, std::string_view expected) {
  if (found == expected) return;
  throw StateError("saved state: " + std::string(what) + " is '" + std::string(found) +
                   "', expected '" + std::string(expected) + "'");
}

constexpr std::string_view kSigns =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string SaveState(const Session& session) {
  std::string state;
  if (session.state() == SessionState::kFaulted) return state;
  state.reserve(64 * 1024);
  FieldSaver saver(&state);
  MakeHead(session.config(), session.StateHash()).Fields(saver);
  session.Save(&state);
  return state;
}

void LoadState(std::string_view state, Session* session) {
  const Head expected = MakeHead(session->config(), 0);
  Head head;
  FieldLoader loader(state, session->config().model.hand.num_fingers());
  head.Fields(loader);
  Expect("format", head.format, expected.format);
  Expect("version", std::to_string(head.version), std::to_string(kVersion));
  Expect("build", head.build, expected.build);
  Expect("hand", head.hand, expected.hand);
  Expect("object", head.object, expected.object);
  Expect("time step", std::to_string(head.dt), std::to_string(expected.dt));
  session->Load(loader.rest());
  if (session->StateHash() != head.state_hash)
    throw StateError("saved state: it was changed, its hash is " + HashText(session->StateHash()) +
                     ", expected " + HashText(head.state_hash));
}

std::string ToBase64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kSigns[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string FromBase64(std::string_view text) {
  static const auto kValues = [] {
    std::array<int, 256> values;
    values.fill(-1);
    for (std::size_t i = 0; i < kSigns.size(); ++i)
      values[static_cast<unsigned char>(kSigns[i])] = static_cast<int>(i);
    return values;
  }();
  const auto refuse = [] { throw StateError("saved state: not base64"); };
  if (text.size() % 4 != 0) refuse();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    const bool last = i + 4 == text.size();
    const std::size_t pads = !last ? 0 : text.substr(i, 4).ends_with("==") ? 2 : text[i + 3] == '=';
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int value = k < 4 - pads ? kValues[static_cast<unsigned char>(text[i + k])] : 0;
      if (value < 0) refuse();
      word = word << 6 | static_cast<std::uint32_t>(value);
    }
    for (std::size_t k = 0; k < 3 - pads; ++k)
      bytes += static_cast<char>(word >> (16 - 8 * k) & 255);
  }
  return bytes;
}

}  // namespace regrasp
