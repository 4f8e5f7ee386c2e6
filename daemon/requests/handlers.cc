#include "daemon/requests/handlers.h"

#include <algorithm>
#include <array>
#include <optional>

namespace regrasp {
namespace {

struct Entry {
  std::string_view method;
  Handler handler;
};

constexpr std::array kHandlers = {
    Entry{"checkpoint.list", handlers::CheckpointList},
    Entry{"checkpoint.restore", handlers::CheckpointRestore},
    Entry{"checkpoint.save", handlers::CheckpointSave},
    Entry{"contacts", handlers::Contacts},
    Entry{"describe", handlers::Describe},
    Entry{"events", handlers::Events},
    Entry{"hello", handlers::Hello},
    Entry{"identity", handlers::Identity},
    Entry{"job.cancel", handlers::JobCancel},
    Entry{"job.get", handlers::JobGet},
    Entry{"job.list", handlers::JobList},
    Entry{"job.wait", handlers::JobWait},
    Entry{"joints", handlers::Joints},
    Entry{"noise.get", handlers::NoiseGet},
    Entry{"noise.set", handlers::NoiseSet},
    Entry{"param.get", handlers::ParamGet},
    Entry{"param.list", handlers::ParamList},
    Entry{"param.load", handlers::ParamLoad},
    Entry{"param.reset", handlers::ParamReset},
    Entry{"param.set", handlers::ParamSet},
    Entry{"pause", handlers::Pause},
    Entry{"plot", handlers::Plot},
    Entry{"push", handlers::Push},
    Entry{"quality", handlers::Quality},
    Entry{"record.list", handlers::RecordList},
    Entry{"record.start", handlers::RecordStart},
    Entry{"record.stop", handlers::RecordStop},
    Entry{"reset", handlers::Reset},
    Entry{"resume", handlers::Resume},
    Entry{"shape", handlers::Shape},
    Entry{"shutdown", handlers::Shutdown},
    Entry{"status", handlers::Status},
    Entry{"step", handlers::Step},
    Entry{"stop", handlers::Stop},
    Entry{"subscribe", handlers::Subscribe},
    Entry{"truth", handlers::Truth},
    Entry{"unsubscribe", handlers::Unsubscribe},
    Entry{"version", handlers::VersionOf},
};
static_assert(std::ranges::is_sorted(kHandlers, {}, &Entry::method));

}  // namespace

Outcome Later(Service& service, std::function<Json()> make) {
  Outcome outcome;
  outcome.begin = [&service, make = std::move(make)](Done done) {
    struct Work {
      Json result;
      std::optional<RpcError> error;
    };
    const auto work = std::make_shared<Work>();
    const auto run = [work, make] {
      try {
        work->result = make();
      } catch (const RpcException& e) {
        work->error = e.error();
      } catch (const std::exception& e) {
        work->error = RpcError{ErrorCode::kIo, e.what(), "look at output_dir in status", {}, {}};
      }
    };
    const auto finish = [work, done] {
      done(std::move(work->result), work->error ? &*work->error : nullptr);
    };
    if (!service.host().Background(run, finish))
      throw RpcException(ErrorCode::kBusy, "too much is waiting for the disk", "try again later");
  };
  return outcome;
}

Handler FindHandler(std::string_view method) {
  if (const Handler start = FindJobHandler(method)) return start;
  const auto it = std::ranges::lower_bound(kHandlers, method, {}, &Entry::method);
  return it != kHandlers.end() && it->method == method ? it->handler : nullptr;
}

}  // namespace regrasp
