#include "cli/run/run_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/journal/check.h"
#include "core/journal/checked_json.h"
#include "core/journal/journal_text.h"
#include "core/journal/run_messages.h"

namespace regrasp::run {
namespace {

void AddConfig(RunFile* file, const McapMessage& message) {
  ConfigRead read = ParseConfig(message.data);
  if (read.segment != static_cast<int>(file->segments.size()))
    throw JournalError(fmt::format("segment {} follows {}", read.segment, file->segments.size()));
  Segment& segment = file->segments.emplace_back();
  segment.journal->config = std::move(read.config);
  segment.build = std::move(read.build);
  segment.offset_ns = message.time;
}

Segment& Of(RunFile* file, int segment) {
  if (segment < 0 || segment >= static_cast<int>(file->segments.size()))
    throw JournalError(fmt::format("segment {} has no beginning", segment));
  return file->segments[static_cast<std::size_t>(segment)];
}

void AddCommand(RunFile* file, std::string_view text) {
  if (file->segments.empty()) throw JournalError("a command before the configuration");
  const EntryRead read = ParseEntry(text, file->segments.back().journal->config);
  auto& entries = Of(file, read.segment).journal->entries;
  if (read.seq != entries.size())
    throw JournalError(fmt::format("tick {}: command {} of segment {} stands where {} is expected",
                                   read.entry.tick, read.seq, read.segment, entries.size()));
  if (!entries.empty() && read.entry.tick < entries.back().tick)
    throw JournalError(fmt::format("tick {}: command {} comes before the one ahead of it",
                                   read.entry.tick, read.seq));
  entries.push_back(read.entry);
}

std::int64_t Integer(const nlohmann::ordered_json& json, const char* key, std::int64_t max) {
  const auto& value = json.at(key);
  if (!value.is_number_integer() || value < 0 || value > max)
    throw JournalError(fmt::format("{} of a state: allowed are integers of 0 ... {}", key, max));
  return value.get<std::int64_t>();
}

void AddState(RunFile* file, std::string_view text) {
  int segment = 0;
  const Segment::State state = ParseState(text, &segment);
  Of(file, segment).states.push_back(state);
}

void AddSavedState(RunFile* file, std::string_view text) {
  const RunSavedState state = ParseSavedState(text);
  Of(file, state.segment)
      .saved.push_back({state.tick, state.commands, state.state_hash, DigestOf(state.bytes)});
}

/// What is known to follow from the commands that are left, after a loss.
void Cut(Segment* segment) {
  std::erase_if(segment->states, [segment](const Segment::State& state) {
    return state.commands > segment->journal->entries.size();
  });
  std::erase_if(segment->saved, [segment](const Segment::Saved& state) {
    return state.commands > segment->journal->entries.size();
  });
}

/// A segment's states in order; without a gap in its commands.
void Finish(const RunFile& file, Segment* segment) {
  std::ranges::stable_sort(segment->states, {}, [](const Segment::State& state) {
    return std::pair(state.tick, state.commands);
  });
  std::ranges::stable_sort(segment->saved, {}, [](const Segment::Saved& state) {
    return std::pair(state.tick, state.commands);
  });
  if (!file.lost.empty()) return Cut(segment);
  const std::size_t known = segment->journal->entries.size();
  const auto check = [known](const auto& states) {
    for (const auto& state : states)
      if (state.commands > known)
        throw JournalError(fmt::format("tick {}: a state after {} commands, where {} are known",
                                       state.tick, state.commands, known));
  };
  check(segment->states);
  check(segment->saved);
}

using Wanted = std::function<bool(const McapChunk&)>;

/// `states`: also those, and the saved ones. `wanted` may be empty: the whole file is read.
RunFile Read(const std::string& path, bool states, const Wanted& wanted) {
  RunFile file;
  std::string fault;  // the first thing that does not follow: a gap, where something was lost
  const auto take = [&](const McapMessage& message) {
    if (!fault.empty()) return;
    try {
      if (message.topic == "run") AddConfig(&file, message);
      if (message.topic == "commands") AddCommand(&file, message.data);
      if (states && message.topic == "state") AddState(&file, message.data);
      if (states && message.topic == "saved_states") AddSavedState(&file, message.data);
    } catch (const JournalError& e) {
      fault = e.what();
    } catch (const StateError& e) {
      fault = e.what();
    } catch (const nlohmann::json::exception& e) {
      fault = fmt::format("a damaged state: {}", e.what());
    }
  };
  try {
    McapSummary summary = wanted ? ReadMcap(path, take, wanted) : ReadMcap(path, take);
    file.complete = summary.complete;
    file.messages = summary.messages;
    file.lost = std::move(summary.lost);
    if (!fault.empty() && (file.lost.empty() || file.segments.empty())) throw JournalError(fault);
    if (file.segments.empty()) throw JournalError("it holds no run");
    for (Segment& segment : file.segments) Finish(file, &segment);
  } catch (const JournalError& e) {
    throw JournalError(path + ": " + e.what());
  }
  return file;
}

}  // namespace

std::int64_t Segment::last_tick() const {
  std::int64_t tick = states.empty() ? 0 : states.back().tick;
  if (!journal->entries.empty()) tick = std::max(tick, journal->entries.back().tick);
  return tick;
}

Segment::State ParseState(std::string_view text, int* segment) {
  const auto json = ParseFileJson(text);
  *segment = static_cast<int>(Integer(json, "segment", 1'000'000));
  return {Integer(json, "tick", kMaxTick),
          static_cast<std::size_t>(Integer(json, "commands", 1'000'000'000)),
          ParseHash(json.at("state_hash").get<std::string>())};
}

std::uint64_t DigestOf(std::string_view bytes) {
  StateHasher hasher;
  for (const char byte : bytes) hasher.Add(byte);
  return hasher.Digest();
}

RunFile ReadRunFile(const std::string& path) { return Read(path, true, {}); }

RunFile ReadJournals(const std::string& path, std::vector<McapChunk>* chunks) {
  return Read(path, false, [chunks](const McapChunk& chunk) {
    chunks->push_back(chunk);
    return chunk.topics.contains("run") || chunk.topics.contains("commands");
  });
}

}  // namespace regrasp::run
