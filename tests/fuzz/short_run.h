#pragma once

/// A short run of the default hand, made once: what fuzz targets change.

#include <string>

#include "core/hand/scenario.h"
#include "core/journal/journal_text.h"
#include "core/journal/saved_state.h"

namespace regrasp {

struct ShortRun {
  SessionConfig config;
  std::string config_text, entry_text, state;
  Checkpoint checkpoint;
};

inline const ShortRun& TheShortRun() {
  static const ShortRun run = [] {
    ShortRun made;
    made.config.model = LoadScenario("shadow", "", ModelSearchPath(""));
    made.config.parameters = DefaultParameters(made.config.model);
    Session session(made.config);
    JournalEntry entry;
    entry.command.type = CommandType::kGrasp;
    entry.command.job = 1;
    session.Apply(entry.command);
    entry.state_hash = session.StateHash();
    for (int i = 0; i < 5; ++i) session.Tick();
    made.config_text = ConfigText(made.config, 0);
    made.entry_text = EntryText(entry, made.config, 0, 0);
    made.state = SaveState(session);
    made.checkpoint = {.name = "c",
                       .tick = session.tick(),
                       .state_hash = session.StateHash(),
                       .build = std::string(BuildIdentity()),
                       .state = "grasping",
                       .commands = 1,
                       .journal = {made.config, {entry}},
                       .saved_state = ToBase64(made.state)};
    return made;
  }();
  return run;
}

}  // namespace regrasp
