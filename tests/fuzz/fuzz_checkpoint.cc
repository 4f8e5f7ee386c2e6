// A checkpoint: its lines edited as JSON, its saved state byte by byte. Refused with a JournalError
// or a StateError, or a session that goes on.

#include "tests/fuzz/json_edits.h"
#include "tests/fuzz/short_run.h"

namespace {

using namespace regrasp;

std::string EditedLines(Decisions* decisions) {
  static const std::string text = CheckpointText(TheShortRun().checkpoint);
  std::string edited;
  for (std::size_t begin = 0, end; begin < text.size(); begin = end + 1) {
    end = text.find('\n', begin);
    const std::string line = text.substr(begin, end - begin);
    if (decisions->Below(16) == 1) continue;  // a line less
    auto json = nlohmann::ordered_json::parse(line);
    if (decisions->Below(2) == 1) Edit(&json, decisions);
    edited += json.dump() + "\n";
    if (decisions->Below(16) == 1) edited += json.dump() + "\n";
  }
  return edited;
}

std::string EditedState(Decisions* decisions) {
  std::string state = TheShortRun().state;
  for (std::size_t n = 1 + decisions->Below(8); n > 0; --n) {
    const std::size_t at = decisions->Below(std::min<std::size_t>(state.size(), 65536));
    state[at] = static_cast<char>(decisions->Below(256));
  }
  if (decisions->Below(8) == 1) state.resize(decisions->Below(state.size()));
  return state;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Decisions decisions(data, size);
  try {
    if (decisions.Below(2) == 0) {
      const std::string text = EditedLines(&decisions);
      (void)ParseCheckpointHead(text.substr(0, text.find('\n')));
      const Checkpoint read = ParseCheckpoint(text);
      if (ParseCheckpoint(CheckpointText(read)).journal.entries.size() !=
          read.journal.entries.size())
        std::abort();
    } else {
      Session session(TheShortRun().config);
      LoadState(EditedState(&decisions), &session);
      for (int i = 0; i < 3; ++i) session.Tick();
    }
  } catch (const JournalError&) {
  } catch (const StateError&) {
  }
  return 0;
}
