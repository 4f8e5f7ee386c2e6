#include "cli/run/run_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/journal/journal_text.h"
#include "core/mcap/mcap_reader.h"

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

void AddState(RunFile* file, std::string_view text) {
  const auto json = nlohmann::json::parse(text);
  Of(file, json.at("segment").get<int>())
      .states.push_back({json.at("tick").get<std::int64_t>(),
                         json.at("commands").get<std::size_t>(),
                         ParseHash(json.at("state_hash").get<std::string>())});
}

}  // namespace

std::int64_t Segment::last_tick() const {
  std::int64_t tick = states.empty() ? 0 : states.back().tick;
  if (!journal->entries.empty()) tick = std::max(tick, journal->entries.back().tick);
  return tick;
}

RunFile ReadRunFile(const std::string& path) {
  RunFile file;
  try {
    const McapSummary summary = ReadMcap(path, [&](const McapMessage& message) {
      if (message.topic == "run") AddConfig(&file, message.data);
      if (message.topic == "commands") AddCommand(&file, message.data);
      if (message.topic == "state") AddState(&file, message.data);
    });
    file.complete = summary.complete;
    file.messages = summary.messages;
    if (file.segments.empty()) throw JournalError("it holds no run");
  } catch (const JournalError& e) {
    throw JournalError(path + ": " + e.what());
  } catch (const nlohmann::json::exception& e) {
    throw JournalError(path + ": a damaged state: " + e.what());
  }
  for (Segment& segment : file.segments)
    std::ranges::stable_sort(segment.states, {}, [](const Segment::State& state) {
      return std::pair(state.tick, state.commands);
    });
  return file;
}

}  // namespace regrasp::run
