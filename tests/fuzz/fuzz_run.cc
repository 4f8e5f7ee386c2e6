// What stands in a run file: the configuration and the commands, edited as JSON. Refused with a
// JournalError, or a session that can be built, written again to the same text and stepped (to a
// fault, where the numbers are absurd).

#include "core/journal/checked_json.h"
#include "tests/fuzz/json_edits.h"
#include "tests/fuzz/short_run.h"

namespace {

using namespace regrasp;

std::string Edited(const std::string& text, std::size_t edits, Decisions* decisions) {
  auto json = nlohmann::ordered_json::parse(text);
  for (; edits > 0; --edits) Edit(&json, decisions);
  return json.dump();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ShortRun& run = TheShortRun();
  Decisions decisions(data, size);
  const std::size_t config_edits = decisions.Below(3), entry_edits = decisions.Below(3);
  try {
    const std::string text = Edited(run.config_text, config_edits, &decisions);
    const ConfigRead read = ParseConfig(text);
    const std::string again = ConfigText(read.config, read.segment);
    if (ConfigText(ParseConfig(again).config, read.segment) != again) std::abort();
    const EntryRead entry =
        ParseEntry(Edited(run.entry_text, entry_edits, &decisions), read.config);
    Session session(read.config);
    session.Apply(entry.entry.command);
    for (int i = 0; i < 3; ++i) session.Tick();
  } catch (const JournalError&) {
  } catch (const ModelError&) {
  }
  return 0;
}
