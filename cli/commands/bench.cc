#include "cli/commands/bench.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/client/daemon_process.h"
#include "cli/client/private_daemon.h"
#include "cli/client/program.h"

namespace regrasp::cli {
namespace {

/// Round trips of `status` for so long: {count, median_s, p99_s}.
Json RoundTrips(const std::string& socket, double seconds) {
  Client client(socket, 10);
  std::vector<double> times;
  for (const auto end = Deadline(seconds); Clock::now() < end;) {
    const auto start = Clock::now();
    client.Call("status", Json::object());
    times.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    CheckInterrupt();
  }
  std::ranges::sort(times);
  return {{"count", times.size()},
          {"median_s", times[times.size() / 2]},
          {"p99_s", times[times.size() * 99 / 100]}};
}

std::string Microseconds(const Json& quantiles, const char* key) {
  return Fixed(At(quantiles, key), 1, 1e6);
}

}  // namespace

ExitCode Bench(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const double seconds = ParseNumber(invocation.Text("seconds", "2"), "--seconds");
  const Finished finished =
      RunProgram({FindDaemon(), "--config", "/dev/null", "--bench", fmt::format("{}", seconds)});
  if (finished.code != 0)
    throw CliError(kFailed, finished.err.substr(0, finished.err.find('\n')), "regrasp doctor");
  Json answer = Json::parse(finished.out);
  for (const char* speed : {"1", "max"}) {
    const PrivateDaemon daemon({"--speed", speed});
    answer["status_round_trip"][std::string("speed_") + speed] =
        RoundTrips(daemon.socket(), seconds);
  }
  context.Print(answer, [&] {
    Output& out = context.out();
    Table table({"[us]", ">sense", ">control", ">collide", ">step", ">tick", ">p99", ">ticks/s",
                 ">real time"});
    for (const auto& [state, m] : answer["states"].items()) {
      const double per_s = m["ticks_per_s"].get<double>();
      table.Row({state, Microseconds(m["sense"], "median_s"),
                 Microseconds(m["control"], "median_s"), Microseconds(m["collide"], "median_s"),
                 Microseconds(m["step"], "median_s"), Microseconds(m["tick"], "median_s"),
                 Microseconds(m["tick"], "p99_s"), fmt::format("{:.0f}", per_s),
                 fmt::format("{:.1f} x", per_s * answer["dt_s"].get<double>())});
    }
    out.Add(table.Text(out));
    out.Line("  medians; p99 of the tick");
    for (const char* speed : {"1", "max"}) {
      const Json& trips = answer["status_round_trip"][std::string("speed_") + speed];
      out.Line(fmt::format("status at --speed {:<4} {:>8} us median {:>8} us p99", speed,
                           Microseconds(trips, "median_s"), Microseconds(trips, "p99_s")));
    }
  });
  return kOk;
}

}  // namespace regrasp::cli
