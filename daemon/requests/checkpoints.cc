// Checkpoints: a journal and the state at its end in a file. To restore is to load the state, or to
// execute the journal again.

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>

#include "core/common/nearest_name.h"
#include "core/files/names.h"
#include "core/journal/journal_text.h"
#include "core/journal/provenance.h"
#include "core/journal/saved_state.h"
#include "daemon/output/files.h"
#include "daemon/requests/handlers.h"

namespace regrasp::handlers {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kSuffix = ".checkpoint";
constexpr std::size_t kMaxName = 64;

fs::path PathOf(Service& service, const Params& params) {
  const std::string name = params.String("name");
  const bool plain = std::ranges::all_of(
      name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; });
  if (name.size() > kMaxName || !plain || !FileNameFault(name).empty())
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                fmt::format("'{}' is not a name for a checkpoint", Shown(name)),
                                "use 1 to 64 letters, digits, - _ . with no dot and no - first",
                                "name",
                                {}});
  return service.config().output_dir / (name + std::string(kSuffix));
}

/// The checkpoints of a directory, by name. Throws where one cannot be read: without it the list
/// would lie. Any thread.
std::vector<Checkpoint> Heads(const fs::path& directory) {
  constexpr std::uint64_t kMaxHead = 4096;  // of the first line; ours have some 400 bytes
  std::vector<Checkpoint> heads;
  for (const fs::path& path : FilesIn(directory, {kSuffix})) {
    std::string head;
    try {
      head = ReadHead(path, kMaxHead);
    } catch (const std::runtime_error&) {
      std::error_code unknown;
      if (fs::exists(path, unknown) || unknown) throw;
      continue;  // deleted meanwhile
    }
    try {
      heads.push_back(ParseCheckpointHead(head.substr(0, head.find('\n'))));
      heads.back().name = path.stem().string();  // also of a copy
    } catch (const std::exception&) {
      continue;  // not one of ours, or damaged: restore tells which
    }
  }
  std::ranges::sort(heads, {}, &Checkpoint::name);
  return heads;
}

Json HeadJson(const Checkpoint& checkpoint, double dt) {
  return {{"name", checkpoint.name},
          {"tick", checkpoint.tick},
          {"time_s", static_cast<double>(checkpoint.tick) * dt},
          {"state", checkpoint.state},
          {"state_hash", HashText(checkpoint.state_hash)},
          {"seed", checkpoint.journal.config.seed},
          {"object", checkpoint.journal.config.model.object.name},
          {"commands", checkpoint.commands},
          {"same_build", checkpoint.build == BuildIdentity()}};
}

/// What a restore needs of a file; made by the worker thread.
struct Restored {
  std::shared_ptr<const Checkpoint> checkpoint;
  /// In the checkpoint's state; null where only executing its commands again leads there: another
  /// build saved it, the file was changed, or that was asked for.
  std::unique_ptr<Session> session;
  std::vector<std::string> differences;
  std::optional<RpcError> error;
};

struct RestoreRequest {
  fs::path path;
  std::string name;
  const HandModel* hand = nullptr;  ///< the daemon's, which never changes
  double dt = 0;                    ///< the daemon's [s]
  bool reexecute = false, reseed = false;
  std::uint64_t seed = 0;
  std::shared_ptr<ModelText> model_text;
};

RpcException Refusal(ErrorCode code, std::string message, std::string hint) {
  return RpcException(RpcError{code, std::move(message), std::move(hint), "name", {}});
}

std::shared_ptr<const Checkpoint> Read(const RestoreRequest& request) {
  if (!fs::exists(request.path)) {
    std::vector<std::string> names;
    for (const fs::path& path : FilesIn(request.path.parent_path(), {kSuffix}))
      names.push_back(path.stem().string());
    std::string hint = DidYouMean(request.name, names);
    if (hint.empty()) hint = "regrasp checkpoint list";
    throw Refusal(ErrorCode::kNotFound, fmt::format("no checkpoint '{}'", request.name),
                  std::move(hint));
  }
  std::shared_ptr<const Checkpoint> checkpoint;
  try {
    checkpoint = std::make_shared<const Checkpoint>(
        ParseCheckpoint(ReadFile(request.path), request.model_text.get()));
  } catch (const std::exception& e) {
    throw Refusal(ErrorCode::kIo, fmt::format("{}: {}", request.path.string(), e.what()),
                  "regrasp checkpoint save NAME");
  }
  const SessionConfig& config = checkpoint->journal.config;
  if (HandBytes(config.model.hand) != HandBytes(*request.hand) || config.world.dt != request.dt)
    throw Refusal(ErrorCode::kBadState,
                  fmt::format("checkpoint '{}' is of another hand ({}) or time step ({} s)",
                              request.name, config.model.hand.name, config.world.dt),
                  "start regraspd with the hand the checkpoint was saved with");
  return checkpoint;
}

std::unique_ptr<Session> Load(const Checkpoint& checkpoint) {
  if (checkpoint.saved_state.empty() || checkpoint.build != BuildIdentity()) return nullptr;
  auto session = std::make_unique<Session>(checkpoint.journal.config);
  try {
    LoadState(FromBase64(checkpoint.saved_state), session.get());
    if (session->StateHash() != checkpoint.state_hash || session->tick() != checkpoint.tick)
      throw StateError("saved state: of another moment");
  } catch (const std::exception& e) {
    throw Refusal(ErrorCode::kIo, fmt::format("checkpoint '{}': {}", checkpoint.name, e.what()),
                  fmt::format("regrasp checkpoint restore {} --reexecute", checkpoint.name));
  }
  return session;
}

Restored ReadAndLoad(const RestoreRequest& request) {
  Restored restored;
  try {
    restored.checkpoint = Read(request);
    restored.differences = BuildAndParameterDifferences(restored.checkpoint->journal.config,
                                                        restored.checkpoint->build);
    if (!request.reexecute) restored.session = Load(*restored.checkpoint);
  } catch (const RpcException& e) {
    restored.error = e.error();
  } catch (const std::exception& e) {
    restored.error = Refusal(ErrorCode::kIo, e.what(), "regrasp checkpoint list").error();
  }
  return restored;
}

/// Hands what was read to the control thread; answers when that has taken it.
void BeginRestore(Service& service, const RestoreRequest& wanted, Restored restored,
                  const Done& done) {
  service.CheckNotRestoring();
  const std::shared_ptr<const Checkpoint> checkpoint = restored.checkpoint;
  ControlRequest request;
  request.kind = ControlRequest::Kind::kRestore;
  request.checkpoint = checkpoint;
  request.session = std::move(restored.session);
  const bool from_state = request.session != nullptr;
  request.command.type = CommandType::kBranch;
  request.command.reseed = wanted.reseed;
  request.command.seed = wanted.seed;
  // The job that goes on comes first: while it waits, the restore is the newest unfinished job.
  if (checkpoint->job.id != 0) request.command.job = service.jobs().Add(checkpoint->job.method).id;
  const std::int64_t continues = request.command.job;
  const std::int64_t id = service.jobs().Add(JobMethod::kRestore).id;
  request.job = id;
  try {
    const std::uint64_t number = service.Post(std::move(request));
    service.AfterTaken(number,
                       [done, answer = Json{{"job", id},
                                            {"continues", continues ? Json(continues) : Json()},
                                            {"tick", checkpoint->tick},
                                            {"state_hash", HashText(checkpoint->state_hash)},
                                            {"from", from_state ? "state" : "commands"},
                                            {"differences", std::move(restored.differences)}}] {
                         done(answer, nullptr);
                       });
  } catch (...) {
    service.jobs().Withdraw(id);
    if (continues) service.jobs().Withdraw(continues);
    throw;
  }
}

}  // namespace

Outcome CheckpointSave(Service& service, const Params& params, Client&) {
  service.CheckNotFaulted();
  const fs::path path = PathOf(service, params);
  Outcome outcome;
  outcome.begin = [&service, path, name = params.String("name")](Done done) {
    service.Mark(
        ControlRequest::Part::kState, [&service, path, name, done](const JournalNews& mark) {
          struct Work {
            Checkpoint checkpoint;
            std::string failure;
            bool replaced = false;
          };
          const auto work = std::make_shared<Work>();
          work->checkpoint = {.name = name,
                              .tick = mark.entry.tick,
                              .state_hash = mark.entry.state_hash,
                              .build = std::string(BuildIdentity()),
                              .state = std::string(Name(mark.state)),
                              .job = mark.job,
                              .commands = service.journal().entries.size(),
                              .journal = service.journal(),
                              .saved_state = ToBase64(*mark.saved)};
          const auto write = [work, path, most = service.config().budgets.checkpoints,
                              model_text = service.model_text()] {
            try {
              work->replaced = fs::exists(path);
              if (!work->replaced && FilesIn(path.parent_path(), {kSuffix}).size() >= most)
                throw std::runtime_error(
                    fmt::format("{} checkpoints are in {}, as many as max_checkpoints allows", most,
                                path.parent_path().string()));
              ReplaceFile(path, CheckpointText(work->checkpoint, model_text.get()));
            } catch (const std::exception& e) {
              work->failure = e.what();
            }
          };
          const auto finish = [&service, work, path, done] {
            if (!work->failure.empty()) {
              const RpcError error{
                  ErrorCode::kIo, work->failure, "look at output_dir in status", {}, {}};
              return done({}, &error);
            }
            Json result = HeadJson(work->checkpoint, service.dt());
            result["path"] = path.string();
            result["replaced"] = work->replaced;
            done(std::move(result), nullptr);
          };
          if (!service.host().Background(write, finish)) {
            const RpcError error{
                ErrorCode::kBusy, "too many files are being written", "try again later", {}, {}};
            done({}, &error);
          }
        });
  };
  return outcome;
}

Outcome CheckpointList(Service& service, const Params&, Client&) {
  return Later(service, [directory = service.config().output_dir, dt = service.dt()]() -> Json {
    Json list = Json::array();
    for (const Checkpoint& head : Heads(directory)) list.push_back(HeadJson(head, dt));
    return {{"checkpoints", std::move(list)}};
  });
}

/// The file is read, and the state loaded, by the worker thread: a long run takes seconds.
Outcome CheckpointRestore(Service& service, const Params& params, Client&) {
  service.CheckNotRestoring();
  RestoreRequest request{.path = PathOf(service, params),
                         .name = params.String("name"),
                         .hand = &service.hand(),
                         .dt = service.dt(),
                         .reexecute = params.Bool("reexecute", false),
                         .reseed = params.Has("seed"),
                         .seed = static_cast<std::uint64_t>(params.Integer("seed", 0)),
                         .model_text = service.model_text()};
  Outcome outcome;
  outcome.begin = [&service, request = std::move(request)](Done done) {
    const auto restored = std::make_shared<Restored>();
    const auto read = [restored, request] { *restored = ReadAndLoad(request); };
    const auto finish = [&service, restored, request, done] {
      if (restored->error) return done({}, &*restored->error);
      try {
        BeginRestore(service, request, std::move(*restored), done);
      } catch (const RpcException& e) {
        done({}, &e.error());
      }
    };
    if (!service.host().Background(read, finish))
      throw RpcException(ErrorCode::kBusy, "too much is waiting for the disk", "try again later");
  };
  return outcome;
}

}  // namespace regrasp::handlers
