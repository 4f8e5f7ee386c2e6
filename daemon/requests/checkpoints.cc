// Checkpoints: a journal and the state at its end in a file. To restore is to load the state, or to
// execute the journal again.

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>

#include "core/files/names.h"
#include "core/journal/journal_text.h"
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
                                "not a name for a checkpoint",
                                "use 1 to 64 letters, digits, - _ . with no dot and no - first",
                                "name",
                                {}});
  return service.config().output_dir / (name + std::string(kSuffix));
}

/// The checkpoints that can be read, by name. Any thread.
std::vector<Checkpoint> Heads(const fs::path& directory) {
  constexpr std::uint64_t kMaxHead = 4096;  // of the first line; ours have some 400 bytes
  std::vector<Checkpoint> heads;
  for (const fs::path& path : FilesIn(directory, {kSuffix})) {
    try {
      const std::string head = ReadHead(path, kMaxHead);
      heads.push_back(ParseCheckpointHead(head.substr(0, head.find('\n'))));
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

std::shared_ptr<const Checkpoint> Read(Service& service, const fs::path& path,
                                       const std::string& name) {
  const auto refuse = [](ErrorCode code, std::string message, std::string hint) {
    throw RpcException(RpcError{code, std::move(message), std::move(hint), "name", {}});
  };
  if (!fs::exists(path)) {
    std::vector<std::string> names;
    for (const Checkpoint& head : Heads(service.config().output_dir)) names.push_back(head.name);
    std::string hint = DidYouMean(name, names);
    if (hint.empty()) hint = "regrasp checkpoint list";
    refuse(ErrorCode::kNotFound, fmt::format("no checkpoint '{}'", name), std::move(hint));
  }
  std::shared_ptr<const Checkpoint> checkpoint;
  try {
    checkpoint = std::make_shared<const Checkpoint>(ParseCheckpoint(ReadFile(path)));
  } catch (const std::exception& e) {
    refuse(ErrorCode::kIo, fmt::format("{}: {}", path.string(), e.what()),
           "regrasp checkpoint save NAME");
  }
  const SessionConfig& config = checkpoint->journal.config;
  if (HandText(config.model.hand) != HandText(service.hand()) || config.world.dt != service.dt())
    refuse(ErrorCode::kBadState,
           fmt::format("checkpoint '{}' is of another hand ({}) or time step ({} s)", name,
                       config.model.hand.name, config.world.dt),
           "start regraspd with the hand the checkpoint was saved with");
  return checkpoint;
}

/// A session in the checkpoint's state, or null where only executing its commands again leads
/// there: another build saved it, or the file was changed.
std::unique_ptr<Session> Load(const Checkpoint& checkpoint) {
  if (checkpoint.saved_state.empty() || checkpoint.build != BuildIdentity()) return nullptr;
  auto session = std::make_unique<Session>(checkpoint.journal.config);
  LoadState(FromBase64(checkpoint.saved_state), session.get());
  if (session->StateHash() != checkpoint.state_hash || session->tick() != checkpoint.tick)
    throw StateError("saved state: of another moment");
  return session;
}

}  // namespace

Outcome CheckpointSave(Service& service, const Params& params, Client&) {
  service.CheckNotFaulted();
  const fs::path path = PathOf(service, params);
  Outcome outcome;
  outcome.begin = [&service, path, name = params.String("name")](Done done) {
    service.Mark([&service, path, name, done](const JournalNews& mark) {
      struct Work {
        Checkpoint checkpoint;
        std::string failure;
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
      const auto write = [work, path, most = service.config().budgets.checkpoints] {
        try {
          if (!fs::exists(path) && FilesIn(path.parent_path(), {kSuffix}).size() >= most)
            throw std::runtime_error(
                fmt::format("{} checkpoints are in {}, as many as max_checkpoints allows", most,
                            path.parent_path().string()));
          ReplaceFile(path, CheckpointText(work->checkpoint));
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

Outcome CheckpointRestore(Service& service, const Params& params, Client&) {
  service.CheckNotRestoring();
  const auto checkpoint = Read(service, PathOf(service, params), params.String("name"));
  ControlRequest request;
  request.kind = ControlRequest::Kind::kRestore;
  request.checkpoint = checkpoint;
  try {
    if (!params.Bool("reexecute", false)) request.session = Load(*checkpoint);
  } catch (const std::exception& e) {
    throw RpcException(
        RpcError{ErrorCode::kIo,
                 fmt::format("checkpoint '{}': {}", checkpoint->name, e.what()),
                 fmt::format("regrasp checkpoint restore {} --reexecute", checkpoint->name),
                 "name",
                 {}});
  }
  const bool from_state = request.session != nullptr;
  request.command.type = CommandType::kBranch;
  request.command.reseed = params.Has("seed");
  request.command.seed = static_cast<std::uint64_t>(params.Integer("seed", 0));
  // The job that goes on comes first: while it waits, the restore is the newest unfinished job.
  if (checkpoint->job.id != 0) request.command.job = service.jobs().Add(checkpoint->job.method).id;
  const std::int64_t continues = request.command.job;
  const std::int64_t id = service.jobs().Add(JobMethod::kRestore).id;
  request.job = id;
  try {
    const std::uint64_t barrier = service.Post(std::move(request));
    return {.result = {{"job", id},
                       {"continues", continues ? Json(continues) : Json()},
                       {"tick", checkpoint->tick},
                       {"state_hash", HashText(checkpoint->state_hash)},
                       {"from", from_state ? "state" : "commands"}},
            .barrier = barrier};
  } catch (...) {
    service.jobs().Withdraw(id);
    if (continues) service.jobs().Withdraw(continues);
    throw;
  }
}

}  // namespace regrasp::handlers
