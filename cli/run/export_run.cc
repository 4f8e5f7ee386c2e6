#include "cli/run/export_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <vector>

#include "cli/run/resample.h"
#include "cli/run/run_tables.h"
#include "core/files/output_file.h"
#include "core/mcap/mcap_writer.h"

namespace regrasp::run {
namespace {

namespace fs = std::filesystem;

/// What belongs to the run however short the stretch.
bool IsJournal(std::string_view topic) {
  return topic == "run" || topic == "commands" || topic == "scene" || topic == "saved_states";
}

/// The messages of the file's last segment in a stretch of time; of its journal all where
/// `whole_journal`, else what describes the run.
McapSummary ReadStretch(const std::string& path, const Stretch& stretch, bool whole_journal,
                        const OnMessage& on_message) {
  std::vector<McapChunk> chunks;
  const RunFile file = ReadJournals(path, &chunks);
  if (whole_journal && file.segments.size() > 1)
    throw std::runtime_error(
        fmt::format("{} has {} segments, of which a stretch would be cut out: add --rate HZ, which "
                    "writes the last one alone",
                    path, file.segments.size()));
  const Segment& segment = file.segments.back();
  const auto time = [&](double time_s) {
    return segment.offset_ns + static_cast<std::uint64_t>(std::min(time_s, 1e9) * 1e9 + 0.5);
  };
  const std::uint64_t begin = time(stretch.from_s), end = time(stretch.to_s);
  if (const std::uint64_t last = LastTime(path, chunks); begin > last)
    RefuseBeginning(stretch.from_s,
                    static_cast<double>(last - std::min(last, segment.offset_ns)) * 1e-9);
  std::uint64_t count = 0;
  McapSummary summary = ReadMcap(
      path,
      [&](const McapMessage& message) {
        const bool always = message.topic == "run" || message.topic == "scene" ||
                            (whole_journal && IsJournal(message.topic));
        const bool here =
            message.time >= (always ? segment.offset_ns : begin) && (always || message.time <= end);
        if (!here) return;
        ++count;
        on_message(message);
      },
      [&](const McapChunk& chunk) {
        if (chunk.end >= begin && chunk.start <= end) return true;
        return std::ranges::any_of(chunk.topics, IsJournal);
      });
  // Chunks of the journal are read wherever they lie; what is lost of them counts where some of it
  // would have been written.
  std::erase_if(summary.lost, [&](const McapLoss& loss) {
    const bool known = loss.end != 0;
    return known && (loss.start > end || (!whole_journal && loss.end < begin));
  });
  summary.messages = count;
  return summary;
}

McapSummary WriteMcap(const std::string& path, const Source& source, const std::string& out) {
  McapWriter writer(out);
  std::map<std::string, std::uint16_t, std::less<>> channels;
  const McapSummary summary = source([&](const McapMessage& message) {
    auto channel = channels.find(message.topic);
    if (channel == channels.end()) {
      CheckFileName(path, "topic", message.topic);
      if (channels.size() >= UINT16_MAX) throw std::runtime_error(path + " holds too many topics");
      writer.Flush();  // a channel stands before its messages
      const std::string topic(message.topic);
      channel = channels
                    .emplace(topic, writer.AddChannel(topic, std::string(message.schema_name),
                                                      std::string(message.schema)))
                    .first;
    }
    writer.Write(channel->second, message.time, message.data);
  });
  CheckHoldsRun(path, channels.contains("run"), summary);
  writer.Finish();
  return summary;
}

/// Every segment, in its place; or the stretch of the last one, which alone is segment 0 of a file
/// that replays.
McapSummary ResampleFile(const std::string& path, const ExportOptions& options,
                         const OnMessage& on_message, std::string* note) {
  McapSummary summary;
  const OnMessage counted = [&](const McapMessage& message) {
    ++summary.messages;
    on_message(message);
  };
  const auto add = [&](int segment) {  // returns how many there are
    RunWindow window(path, options.stretch, 0, segment);
    if (note->empty()) *note = window.note();
    ResampledPlace place{options.format == "mcap" ? 0 : window.number(), 0};
    if (options.whole) place = {segment, window.segment().offset_ns};
    Resample(&window, options.rate_hz, place, counted);
    summary.complete = window.file().complete;
    AddLosses(window.Losses(), &summary.lost);
    return static_cast<int>(window.file().segments.size());
  };
  if (!options.whole) add(RunWindow::kLast);
  for (int i = 0, n = options.whole ? 1 : 0; i < n; ++i) n = add(i);
  return summary;
}

}  // namespace

ExportResult ExportRun(const std::string& path, const ExportOptions& options, const OnRun& on_run) {
  const std::string& format = options.format;
  CheckWritable(options.out, Draft::Existing::kKeep);
  RemoveAbandonedDrafts(fs::path(options.out).parent_path());
  ExportResult result;
  const Source source = [&](const OnMessage& to_output) {
    const OnMessage on_message = [&](const McapMessage& message) {
      if (message.topic == "run") on_run(message.data);
      to_output(message);
    };
    if (options.rate_hz > 0) return ResampleFile(path, options, on_message, &result.note);
    if (options.whole) return ReadMcap(path, on_message);
    return ReadStretch(path, options.stretch, format == "mcap", on_message);
  };
  McapSummary summary;
  result.files = 1;
  const auto write = [&](const std::string& draft) {
    if (format == "mcap") {
      summary = WriteMcap(path, source, draft);
      return;
    }
    const RunTables run = ReadTables(path, source, &summary);
    if (format == "npz") WriteNpz(run, draft);
    if (format == "csv") {
      for (const auto& [name, rows] : run.topics)
        WriteCsv(run, rows, fs::path(draft) / (name + ".csv"));
      result.files = run.topics.size();
    }
  };
  WriteOutput(options.out, Draft::Existing::kKeep, write,
              format == "csv" ? Draft::Kind::kDirectory : Draft::Kind::kFile);
  result.messages = summary.messages;
  result.complete = summary.complete;
  result.lost = std::move(summary.lost);
  return result;
}

}  // namespace regrasp::run
