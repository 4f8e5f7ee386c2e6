// Run files.

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <fstream>

#include "daemon/output/files.h"
#include "daemon/output/recorder.h"
#include "daemon/requests/handlers.h"

namespace regrasp::handlers {
namespace {

namespace fs = std::filesystem;
constexpr double kDefaultRate = 25;  // [Hz]

std::string FreeName(const fs::path& directory) {
  std::error_code ignored;
  for (int number = 1;; ++number)
    if (std::string name = fmt::format("run-{:03}.mcap", number);
        !fs::exists(fs::symlink_status(directory / name, ignored)))
      return name;
}

/// Size, and whether it ends as a finished file does; null where that cannot be told.
Json FileJson(const fs::path& path, const fs::path& recording) {
  Json json = {{"file", path.filename().string()},
               {"bytes", nullptr},
               {"complete", nullptr},
               {"recording", path == recording}};
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) return json;
  json["bytes"] = bytes;
  std::ifstream in(path, std::ios::binary);  // of a regular file, see FilesIn()
  if (!in) return json;
  char end[8] = {};
  in.seekg(-8, std::ios::end);
  in.read(end, sizeof end);
  json["complete"] = in && std::string_view(end, sizeof end) == "\x89MCAP0\r\n";
  return json;
}

/// Ends the recording by `recorder` and answers with what the file has.
void FinishRecording(Service& service, const std::shared_ptr<Recorder>& recorder,
                     const Done& done) {
  if (service.recorder() == recorder) {
    service.SetRecorder(nullptr);
  } else if (!service.recording_end.empty()) {  // it has ended by itself meanwhile
    const RpcError error{
        ErrorCode::kIo, std::exchange(service.recording_end, {}), "regrasp record list", {}, {}};
    return done({}, &error);
  } else {  // another client was faster
    const RpcError error{
        ErrorCode::kBadState, "nothing is being recorded", "regrasp record start", {}, {}};
    return done({}, &error);
  }
  const auto finish = [recorder, done] {
    const Recorder::Numbers numbers = recorder->numbers();
    if (!numbers.failure.empty()) {
      const RpcError error{ErrorCode::kIo, numbers.failure, "regrasp record list", {}, {}};
      return done({}, &error);
    }
    done({{"file", recorder->path().filename().string()},
          {"path", recorder->path().string()},
          {"messages", numbers.messages},
          {"bytes", numbers.bytes},
          {"dropped", numbers.dropped}},
         nullptr);
  };
  if (service.host().Background([recorder] { recorder->Finish(); }, finish)) return;
  recorder->Finish();
  finish();
}

}  // namespace

Outcome RecordStart(Service& service, const Params& params, Client&) {
  if (service.recorder())
    throw RpcException(
        ErrorCode::kBadState,
        fmt::format("{} is being recorded", service.recorder()->path().filename().string()),
        "regrasp record stop");
  const fs::path& directory = service.config().output_dir;
  const double rate_hz = params.Number("rate_hz", kDefaultRate);
  const std::string file =
      CheckedFileName(params.Has("file") ? params.String("file") : FreeName(directory), "file",
                      {".mcap"}, "run.mcap");
  std::error_code error;
  fs::create_directories(directory, error);
  if (error)
    throw RpcException(
        ErrorCode::kIo,
        fmt::format("cannot make the directory {}: {}", directory.string(), error.message()),
        "regrasp up --output-dir DIR");
  try {
    service.SetRecorder(std::make_shared<Recorder>(directory / file, rate_hz, service.journal(),
                                                   service.run(),
                                                   service.config().budgets.recording_bytes));
  } catch (const std::exception& e) {
    throw RpcException(RpcError{
        ErrorCode::kIo, e.what(), "another name, or regrasp record start without one", "file", {}});
  }
  service.recording_end.clear();
  service.recorder()->Add(service.newest());
  service.recorder()->AwaitJournal();
  return {.result = {{"file", file},
                     {"path", (directory / file).string()},
                     {"rate_hz", rate_hz},
                     {"tick", service.newest().frame.tick},
                     {"commands", service.journal().entries.size()}}};
}

Outcome RecordStop(Service& service, const Params&, Client&) {
  if (!service.recorder() && !service.recording_end.empty())
    throw RpcException(ErrorCode::kIo, std::exchange(service.recording_end, {}),
                       "regrasp record list");
  if (!service.recorder())
    throw RpcException(ErrorCode::kBadState, "nothing is being recorded", "regrasp record start");
  Outcome outcome;
  outcome.begin = [&service](Done done) {
    // What has happened until now belongs to it: commands, which are here with the mark, and the
    // frames and events before it, which are shown later.
    service.Mark(ControlRequest::Part::kNothing,
                 [&service, recorder = service.recorder(), done](const JournalNews& mark) {
                   service.AfterTaken(mark.request, [&service, recorder, done] {
                     FinishRecording(service, recorder, done);
                   });
                 });
  };
  return outcome;
}

Outcome RecordList(Service& service, const Params&, Client&) {
  const fs::path recording = service.recorder() ? service.recorder()->path() : fs::path();
  return Later(service, [directory = service.config().output_dir, recording]() -> Json {
    Json list = Json::array();
    for (const fs::path& path : FilesIn(directory, {".mcap"}))
      list.push_back(FileJson(path, recording));
    return {{"recordings", std::move(list)}};
  });
}

}  // namespace regrasp::handlers
