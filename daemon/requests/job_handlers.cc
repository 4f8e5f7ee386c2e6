// Requests about jobs.

#include <fmt/format.h>

#include "daemon/requests/handlers.h"

namespace regrasp::handlers {
namespace {

const JobRecord& Existing(Service& service, const Params& params) {
  const std::int64_t id = params.Integer("id", 0);
  if (const JobRecord* job = service.jobs().Find(id)) return *job;
  throw RpcException(RpcError{ErrorCode::kNotFound,
                              fmt::format("no job {}", id),
                              "call job.list for the last jobs",
                              "id",
                              {}});
}

}  // namespace

Outcome JobGet(Service& service, const Params& params, Client&) {
  return {.result = service.JobAnswer(Existing(service, params))};
}

Outcome JobList(Service& service, const Params&, Client&) {
  Json jobs = Json::array();
  for (const JobRecord& job : service.jobs().jobs()) jobs.push_back(service.JobAnswer(job));
  return {.result = {{"jobs", std::move(jobs)}}};
}

Outcome JobCancel(Service& service, const Params& params, Client&) {
  const JobRecord& job = Existing(service, params);
  if (Ended(job.state)) return {.result = service.JobAnswer(job)};
  const std::int64_t id = job.id;
  std::uint64_t barrier = 0;
  if (job.method == JobMethod::kStep || job.method == JobMethod::kRestore) {
    barrier = service.Post({.kind = ControlRequest::Kind::kCancelStep, .job = id});
  } else {
    service.CheckAllowed(CommandType::kCancelJob);
    Command command;
    command.type = CommandType::kCancelJob;
    command.job = id;
    barrier = service.PostCommand(std::move(command));
  }
  return {.barrier = barrier, .later = [&service, id] {
            const JobRecord* now = service.jobs().Find(id);
            return now ? service.JobAnswer(*now) : Json();
          }};
}

Outcome JobWait(Service& service, const Params& params, Client&) {
  const std::int64_t id = Existing(service, params).id;
  const bool limited = params.Has("timeout_s");
  const double timeout_s = params.Number("timeout_s", 0);
  Outcome outcome;
  outcome.overtaken = true;
  struct Pending {
    std::uint64_t timer = 0, waiter = 0;
  };
  const auto pending = std::make_shared<Pending>();
  outcome.abandon = [&service, pending] {
    service.jobs().StopWaiting(pending->waiter);
    service.host().Cancel(pending->timer);
  };
  outcome.begin = [&service, pending, id, limited, timeout_s](Done done) {
    pending->waiter = service.jobs().Wait(id, [&service, pending, done](const JobRecord& job) {
      if (pending->timer) service.host().Cancel(pending->timer);
      done(service.JobAnswer(job), nullptr);
    });
    if (pending->waiter == 0 || !limited) return;
    pending->timer = service.host().After(timeout_s, [&service, pending, done, id, timeout_s] {
      service.jobs().StopWaiting(pending->waiter);
      const RpcError error{ErrorCode::kTimeout,
                           fmt::format("job {} has not ended after {} s", id, timeout_s),
                           fmt::format("regrasp job wait {}", id),
                           "timeout_s",
                           {}};
      done({}, &error);
    });
  };
  return outcome;
}

}  // namespace regrasp::handlers
