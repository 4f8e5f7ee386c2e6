#include "daemon/requests/status_text.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/journal/journal_text.h"
#include "daemon/output/recorder.h"
#include "daemon/requests/service.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

Json JobShown(const Service& service) {
  if (const JobRecord* pending = service.jobs().Unfinished()) return service.JobAnswer(*pending);
  const JobRecord* last = service.jobs().Find(service.newest().frame.job.id);
  return last ? service.JobAnswer(*last) : Json();
}

/// Of the object where it begins, and of the output directory as it was at the start.
Json WarningsOf(const Service& service) {
  Json warnings = service.accepted().warnings;
  if (const ServiceConfig& config = service.config(); !config.output_fault.empty())
    warnings.push_back(fmt::format("output_dir {}: {}; pictures and run files will fail",
                                   config.output_dir.string(), config.output_fault));
  return warnings;
}

Json UntilTimes(const Service& service) {
  const Published& newest = service.newest();
  const Frame& frame = newest.frame;
  const std::optional<double> speed_now = service.real_time_factor();
  return {{"version", Version()},
          {"protocol", kWireVersion},
          {"state", Name(frame.state)},
          {"paused", newest.paused},
          {"clock", ClockName(service.clock())},
          {"advancing", newest.advancing},
          {"tick", frame.tick},
          {"time_s", frame.time_s},
          {"dt_s", service.dt()},
          {"state_hash", HashText(frame.state_hash)},
          {"real_time_factor", speed_now ? Json(*speed_now) : Json()}};
}

Json UntilCounts(const Service& service) {
  const Frame& frame = service.newest().frame;
  const double speed = service.speed();
  const auto& recorder = service.recorder();
  return {{"speed", std::isinf(speed) ? Json("max") : Json(speed)},
          {"stepper", Name(service.config().control.session.world.stepper)},
          {"stepper_reason", service.config().stepper_reason},
          {"seed", frame.seed},
          {"hand", service.hand().name},
          {"object", service.accepted().object->name},
          {"warnings", WarningsOf(service)},
          {"stand_in", frame.stand_in},
          {"holds_alone", HoldsAlone(frame.state, frame.stand_in)},
          {"job", JobShown(service)},
          {"incident", service.incident_summary()},
          {"gait", GaitJson(frame.gait, service.hand())},
          {"noise", NoiseJson(service.accepted().noise)},
          {"changed_parameters", service.ChangedParameters()},
          {"recording", recorder ? Json(recorder->path().filename().string()) : Json()}};
}

}  // namespace

StatusText::StatusText(const Service& service)
    : pieces_{Members(UntilTimes(service)), Members(UntilCounts(service)),
              Members({{"output_dir", service.config().output_dir.string()}})} {}

std::string StatusText::Fields(const Service& service) const {
  const ControlLoop& control = service.control();
  const std::chrono::duration<double> uptime = std::chrono::steady_clock::now() - service.started();
  return fmt::format(R"({},"tick_p99_s":{},"lateness_p99_s":{},{},)"
                     R"("clients":{},"backlog":{},"frames_dropped":{},"uptime_s":{},{})",
                     pieces_[0], Json(control.tick_p99()).dump(),
                     Json(control.lateness_p99()).dump(), pieces_[1], service.host().clients(),
                     control.backlog(), control.dropped(), Json(uptime.count()).dump(), pieces_[2]);
}

std::string Members(const Json& object) {
  const std::string text = ToText(object);
  return text.substr(1, text.size() - 2);
}

}  // namespace regrasp
