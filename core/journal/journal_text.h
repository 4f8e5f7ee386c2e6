#pragma once

/// Journals as JSON text. Every number keeps its bits; models are inside, so that a run can be
/// repeated without the files it was made from.

#include <string>
#include <string_view>

#include "core/journal/journal.h"
#include "core/journal/model_text.h"

namespace regrasp {

/// The configuration of a run: {format, build, segment, hand, object, seed, noise, parameters,
/// world, model}. One line. `known`: where the model and its text are kept for the next time, here
/// and below.
std::string ConfigText(const SessionConfig& config, int segment, ModelText* known = nullptr);
struct ConfigRead {
  SessionConfig config;
  std::string build;
  int segment = 0;
};
/// Throws JournalError that names the field.
ConfigRead ParseConfig(std::string_view text, ModelText* known = nullptr);

/// A command: {segment, seq, tick, t_s, method, ..., state_hash}. `seq` counts the commands of the
/// run from 0.
std::string EntryText(const JournalEntry& entry, const SessionConfig& config, int segment,
                      std::size_t seq);
struct EntryRead {
  JournalEntry entry;
  int segment = 0;
  std::size_t seq = 0;
};
EntryRead ParseEntry(std::string_view text, const SessionConfig& config);

/// A model as it was read from its files: 64 bits over everything that the simulation and the
/// controller take from them, so that the same files elsewhere, or written otherwise, are the same.
struct ModelHashes {
  std::uint64_t scenario = 0, hand = 0, object = 0;
};
ModelHashes HashModels(const LoadedScenario& model);

/// A checkpoint as JSON lines: what it is, the configuration, the commands, the saved state.
std::string CheckpointText(const Checkpoint& checkpoint, ModelText* known = nullptr);
/// Throws JournalError. A saved state that does not belong to the lines before it (the file was
/// changed) is left out.
Checkpoint ParseCheckpoint(std::string_view text, ModelText* known = nullptr);
/// Only what the first line tells: everything but the journal.
Checkpoint ParseCheckpointHead(std::string_view line);

}  // namespace regrasp
