#include "cli/top/top.h"

#include <fmt/format.h>
#include <unistd.h>

#include <map>

#include "cli/top/keys.h"
#include "cli/top/terminal.h"

namespace regrasp::cli {
namespace {

constexpr double kRate = 10;           // frames and samples a second
constexpr double kMessageSeconds = 6;  // how long an answer stays in the last row

/// One session of the dashboard.
class Dashboard {
 public:
  /// Before the terminal is taken over: an absent daemon is an ordinary error.
  explicit Dashboard(Context& context) : context_(context) { Connect(); }

  ExitCode Run() {
    FullScreen terminal(context_.out().color());
    const auto period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / kRate));
    auto next = Clock::now();
    while (true) {
      if (Clock::now() >= next) {
        Draw(&terminal);
        next = std::max(next + period, Clock::now());
      }
      pollfd fds[] = {{STDIN_FILENO, POLLIN, 0}, {context_.client().fd(), POLLIN, 0}};
      WaitForAny(fds, next);
      if (fds[1].revents != 0) Listen();
      if ((fds[0].revents & (POLLHUP | POLLERR)) != 0) return kInterrupted;  // the terminal is gone
      bool pressed = false;
      while (const int key = terminal.Key()) {
        pressed = true;
        Press(key);
        if (keys_.quit()) return kOk;
      }
      if (pressed) next = Clock::now();
    }
  }

 private:
  void Draw(FullScreen* terminal) {
    Overlay overlay = keys_.Shown();
    if (Clock::now() < message_until_ && overlay.keys.empty()) {
      overlay.message = message_;
      overlay.message_ink = message_ink_;
    }
    terminal->Show(DrawDashboard(terminal->rows(), terminal->columns(), context_.out().utf8(),
                                 model_, overlay));
  }

  void Press(int key) {
    message_until_ = {};
    const auto request = keys_.Press(key, model_);
    if (!request) return;
    asked_[context_.client().Post(request->method, request->params)] = request->method;
    Say(request->method + " …", Ink::kDim);
  }

  void Connect() {
    Client& client = context_.client();
    model_ = {};
    asked_.clear();
    const Json past = client.Call("events", {{"count", 50}});
    for (const Json& event : At(past, "events")) model_.Add("events", event);
    const Json jobs = client.Call("job.list", Json::object());
    for (const Json& job : At(jobs, "jobs")) model_.Remember(job);
    for (const char* topic : {"status", "contacts", "quality"})
      model_.Add(topic, client.Call(topic, Json::object()));
    for (const char* topic : {"status", "contacts", "quality", "events"}) {
      Json params = {{"topic", topic}};
      if (std::string_view(topic) != "events") params["rate_hz"] = kRate;
      client.Call("subscribe", params);
    }
  }

  /// Messages; a connection that was lost is made again, once: a daemon ends that of a client which
  /// does not read, as this one while the user has it stopped with Ctrl-Z.
  void Listen() {
    try {
      TakeMessages();
    } catch (const CliError& lost) {
      if (lost.code != kNoDaemon) throw;
      context_.Disconnect();
      try {
        Connect();
      } catch (const CliError& error) {
        if (error.code != kNoDaemon) throw;
        throw lost;
      }
      Say("the daemon had closed the connection: connected again", Ink::kWarn);
    }
  }

  void TakeMessages() {
    while (auto message = context_.client().Receive(0)) {
      if (message->id == 0) {
        model_.Add(message->body.value("topic", ""), message->body);
      } else if (const auto it = asked_.find(message->id); it != asked_.end()) {
        Answer(it->second, *message);
        asked_.erase(it);
      }
    }
  }

  void Answer(const std::string& method, const Client::Message& message) {
    const Json& body = message.body;
    if (message.error) {
      const std::string& hint = message.error->hint;
      Say(method + ": " + message.error->what() + (hint.empty() ? "" : "; try: " + hint),
          Ink::kBad);
    } else if (At(body, "job").is_number()) {
      Say(fmt::format("job {} started: {}", Plain(At(body, "job")), method), Ink::kGood);
    } else if (At(body, "path").is_string()) {
      Say("picture: " + Plain(At(body, "path")), Ink::kGood);
    } else if (method == "noise.set") {
      Say(fmt::format("noise {}: contact position {} mm, force {} N", Plain(At(body, "preset")),
                      Fixed(At(body, "position_m"), 2, 1e3), Fixed(At(body, "force_n"), 3)),
          Ink::kGood);
      // A paused simulation publishes no new status.
      Json status = model_.status();
      status["noise"] = body;
      model_.Add("status", status);
    } else {
      Say(method + ": done", Ink::kGood);
    }
  }

  void Say(std::string text, Ink ink) {
    message_ = std::move(text);
    message_ink_ = ink;
    message_until_ = Deadline(kMessageSeconds);
  }

  Context& context_;
  DashboardModel model_;
  Keys keys_;
  std::map<long, std::string> asked_;  ///< requests under way: id and method
  std::string message_;
  Ink message_ink_ = Ink::kPlain;
  Clock::time_point message_until_ = {};
};

}  // namespace

ExitCode Top(Context& context, const Invocation&) {
  if (!context.out().human()) {
    throw CliError(kUsage, "top draws for people", "regrasp watch status --json");
  }
  const Interruptible interruptible;
  try {
    return Dashboard(context).Run();
  } catch (const CliError& error) {
    if (error.code != kInterrupted) throw;
    return kInterrupted;
  }
}

}  // namespace regrasp::cli
