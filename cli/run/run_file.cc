#include "cli/run/run_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/journal/check.h"
#include "core/journal/checked_json.h"
#include "core/journal/journal_text.h"

namespace regrasp::run {
namespace {

void AddConfig(RunFile* file, std::string_view text) {
  ConfigRead read = ParseConfig(text);
  if (read.segment != static_cast<int>(file->segments.size()))
    throw JournalError(fmt::format("segment {} follows {}", read.segment, file->segments.size()));
  Segment& segment = file->segments.emplace_back();
  segment.journal->config = std::move(read.config);
  segment.build = std::move(read.build);
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
  const auto json = ParseFileJson(text);
  Of(file, static_cast<int>(Integer(json, "segment", 1'000'000)))
      .states.push_back({Integer(json, "tick", kMaxTick),
                         static_cast<std::size_t>(Integer(json, "commands", 1'000'000'000)),
                         ParseHash(json.at("state_hash").get<std::string>())});
}

/// What is known to follow from the commands that are left, after a loss.
void Cut(Segment* segment) {
  std::erase_if(segment->states, [segment](const Segment::State& state) {
    return state.commands > segment->journal->entries.size();
  });
}

/// A segment's states in order; without a gap in its commands.
void Finish(const RunFile& file, Segment* segment) {
  std::ranges::stable_sort(segment->states, {}, [](const Segment::State& state) {
    return std::pair(state.tick, state.commands);
  });
  if (!file.lost.empty()) return Cut(segment);
  const std::size_t known = segment->journal->entries.size();
  for (const Segment::State& state : segment->states)
    if (state.commands > known)
      throw JournalError(fmt::format("tick {}: a state after {} commands, where {} are known",
                                     state.tick, state.commands, known));
}

}  // namespace

std::int64_t Segment::last_tick() const {
  std::int64_t tick = states.empty() ? 0 : states.back().tick;
  if (!journal->entries.empty()) tick = std::max(tick, journal->entries.back().tick);
  return tick;
}

RunFile ReadRunFile(const std::string& path) {
  RunFile file;
  std::string fault;  // the first thing that does not follow: a gap, where something was lost
  try {
    McapSummary summary = ReadMcap(path, [&](const McapMessage& message) {
      if (!fault.empty()) return;
      try {
        if (message.topic == "run") AddConfig(&file, message.data);
        if (message.topic == "commands") AddCommand(&file, message.data);
        if (message.topic == "state") AddState(&file, message.data);
      } catch (const JournalError& e) {
        fault = e.what();
      } catch (const nlohmann::json::exception& e) {
        fault = fmt::format("a damaged state: {}", e.what());
      }
    });
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

}  // namespace regrasp::run
