#pragma once

/// What the I/O thread knows and does, apart from sockets: it validates requests against the method
/// table, assigns jobs, talks to the control loop and answers from the newest frame.

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/hand/scenario.h"
#include "core/journal/model_text.h"
#include "core/protocol/methods.h"
#include "core/session/parameters.h"
#include "daemon/loop/control_loop.h"
#include "daemon/output/history.h"
#include "daemon/output/incident.h"
#include "daemon/requests/jobs.h"
#include "daemon/requests/params.h"
#include "daemon/requests/status_text.h"
#include "daemon/wire/json.h"
#include "daemon/wire/rpc.h"

namespace regrasp {

class Recorder;

/// Called once with a result, or with an error; further calls do nothing. When its last copy goes
/// without a call, the request is answered with an internal error.
using Done = std::function<void(Json result, const RpcError* error)>;

/// `quality` without what no frame has: quick to make.
inline constexpr const char* kFrameQuality = "quality of a frame";

/// What a topic says of a moment, as text, made once for all who ask.
struct Sample {
  double time_s = 0;
  std::string fields;  ///< the members of a JSON object, without its braces
};

/// What a handler answers. Exactly one of: `result` (or `text`, the same written out) now; `later`
/// once the control thread has taken request `barrier`; or whatever `begin` passes to its Done at
/// any later time.
struct Outcome {
  Json result = {};
  std::string text = {};
  std::uint64_t barrier = 0;  ///< hold the answer until ControlLoop::acknowledged() reaches this
  std::function<Json()> later = {};  ///< makes the result then; empty: `result`
  std::function<void(Done)> begin = {};
  bool overtaken = false;  ///< with `begin`: later requests of the connection go on meanwhile
  std::function<void()> abandon = {};  ///< with `begin`: the client has gone, nobody waits any more
};

/// The connection a request came from, as handlers see it.
class Client {
 public:
  virtual ~Client() = default;
  /// Returns the number of the new subscription. Throws RpcException (busy) over the limit.
  virtual std::int64_t Subscribe(const std::string& topic, double rate_hz) = 0;
  /// Its last {sub, seq, dropped}; null when there is none of this number.
  virtual Json Unsubscribe(std::int64_t sub) = 0;
};

/// What the daemon keeps at most; docs/promises.md says what happens at each limit.
struct Budgets {
  std::uint64_t recording_bytes = std::uint64_t{4} << 30;          ///< of one run file
  std::size_t incidents = 100, pictures = 500, checkpoints = 200;  ///< files
  std::size_t commands = 200'000;                                  ///< of one run
};

struct ServiceConfig {
  Budgets budgets;
  ControlConfig control;
  std::string stepper_reason;                      ///< why `control` has the stepper that it has
  std::vector<std::filesystem::path> search_path;  ///< for `reset {object}`
  LoadOptions load;                                ///< for `reset {object}`
  std::filesystem::path output_dir;                ///< for pictures
  std::string output_fault;                        ///< why nothing can be written there, or ""
  /// Where parameters that the configuration sets stand: "FILE:LINE", by name.
  std::map<std::string, std::string> parameter_origins;
};

/// Timers and threads that handlers need; the server provides them.
class Host {
 public:
  virtual ~Host() = default;
  /// Calls `action` on the I/O thread after `seconds`, unless cancelled with the key it returns.
  virtual std::uint64_t After(double seconds, std::function<void()> action) = 0;
  virtual void Cancel(std::uint64_t key) = 0;
  /// Runs `work` on the worker thread, then `finish` on the I/O thread. False when too much is
  /// waiting.
  virtual bool Background(std::function<void()> work, std::function<void()> finish) = 0;
  virtual std::size_t clients() const = 0;
  virtual void Shutdown() = 0;
  /// True when a service manager owns the socket, and starts a daemon at the next connection.
  virtual bool activated() const = 0;
};

class Service {
 public:
  /// Starts the control loop. Throws what Session throws.
  Service(ServiceConfig config, Host* host);

  /// Looks the method up, checks the parameters, runs the handler. Throws RpcException.
  Outcome Call(const std::string& method, const JsonIn& params, Client* client);

  /// Takes in what the control loop has published: newest frame, history, jobs (whose waiters are
  /// called), events. Returns the new events, as subscribers get them. Call after
  /// ControlLoop::output() was notified.
  /// Should it throw (no memory is left), no job and no command has been lost: call it again.
  std::vector<Sample> Drain();

  /// The last drop or fault since the start; null when there was none.
  const std::shared_ptr<const Incident>& incident() const { return incident_; }
  /// Where its record is and what it says, for `status`; null when there was none.
  const Json& incident_summary() const { return incident_summary_; }
  /// The record of a job, with the incident that ended it.
  Json JobAnswer(const JobRecord& job) const;

  /// The present value of a subscription topic other than events, or of kFrameQuality; valid until
  /// the next call. Made once for all who ask until changes() grows; of `status` all but what
  /// changes by itself.
  const Sample& Topic(const std::string& topic);
  /// Grows with every change of what topics show: the one place that says what that is.
  std::uint64_t changes() const {
    return frame_number_ + accepted_changes_ + jobs_.changes() + recorder_changes_ + incidents_;
  }
  /// Changes whenever a new frame has come in.
  std::uint64_t frame_number() const { return frame_number_; }

  // For the handlers.
  ControlLoop& control() { return control_; }
  const ControlLoop& control() const { return control_; }
  Host& host() const { return *host_; }
  JobTable& jobs() { return jobs_; }
  const JobTable& jobs() const { return jobs_; }
  const Published& newest() const { return newest_; }
  const History& history() const { return history_; }
  /// The last ones, oldest first, as `events` lists them: JSON objects.
  const std::deque<std::string>& events() const { return events_; }
  const HandModel& hand() const { return config_.control.session.model.hand; }
  const ServiceConfig& config() const { return config_; }
  double dt() const { return config_.control.session.world.dt; }
  /// 0 while time stands still, unknown in the first moments after that.
  std::optional<double> real_time_factor() const {
    return newest_.advancing ? real_time_factor_ : std::optional<double>(0.0);
  }
  double speed() const { return config_.control.speed; }
  ClockMode clock() const { return config_.control.clock; }
  std::chrono::steady_clock::time_point started() const { return started_; }
  /// The names behind a dynamic enumeration, now.
  std::vector<std::string> Names(NameSource source) const;

  /// The present run up to now: every command that was applied.
  const Journal& journal() const { return journal_; }
  std::uint64_t run() const { return run_; }  ///< its number
  /// The run file that is being written, or null.
  const std::shared_ptr<Recorder>& recorder() const { return recorder_; }
  /// What checkpoints say of the model, made once. For the worker thread.
  const std::shared_ptr<ModelText>& model_text() const { return model_text_; }
  /// So that the first checkpoint is as quick as the others. Once the host can do it.
  void PrepareModelText();
  /// Returns the one before.
  std::shared_ptr<Recorder> SetRecorder(std::shared_ptr<Recorder> recorder);
  /// Why the last one ended by itself, until somebody asked: it failed, or was full.
  std::string recording_end;
  /// Asks for the tick and the state hash of this moment, after every command accepted before;
  /// `told` is called on the I/O thread when journal() is complete up to there.
  void Mark(ControlRequest::Part part, std::function<void(const JournalNews&)> told);
  /// Calls `then` on the I/O thread once the control thread has taken `request` and the frames that
  /// show it are here.
  void AfterTaken(std::uint64_t request, std::function<void()> then);
  /// What waits for requests up to this one happens. Call after Drain().
  void OnAcknowledged(std::uint64_t request);

  /// Values as accepted, which the simulation may not have seen yet (it has after its next tick).
  struct Accepted {
    Parameters parameters;
    /// What these are unless somebody changes them: built in, or of the present models.
    Parameters defaults;
    NoiseLevels noise;
    std::uint64_t seed = 1;
    std::shared_ptr<const ObjectModel> object;
    /// What keeps this object from being grasped: it begins inside a link.
    std::vector<std::string> warnings;
    bool paused = false;
  };
  const Accepted& accepted() const { return accepted_; }
  /// To change any of them.
  Accepted& Accept();
  void AcceptObject(std::shared_ptr<const ObjectModel> object);

  /// The parameters that differ from their defaults: {NAME: value}.
  Json ChangedParameters() const;
  /// Where the present value comes from: the table's source while it is the default.
  std::string SourceOfValue(const ParameterInfo& info) const;
  /// The commands, whose values are allowed, are queued together, presets first; or, with busy or
  /// bad state thrown, not at all. Returns the request after which all have taken effect, 0 where
  /// there are none.
  std::uint64_t SetParameters(std::vector<Command> commands);

  /// Throws busy, bad state or simulation fault unless the command may be given now.
  void CheckAllowed(CommandType type) const;
  void CheckNotFaulted() const;
  /// Throws bad state where such a job cannot run with these parameters.
  void CheckMeasure(const Parameters& parameters, JobMethod method, Criterion criterion) const;
  /// Throws busy while a checkpoint is being restored.
  void CheckNotRestoring() const;
  /// Queues a request; throws busy when there is no room.
  std::uint64_t Post(ControlRequest request);
  /// The same for a command that takes effect at a tick; refuses to let too many pile up while
  /// paused.
  std::uint64_t PostCommand(Command command);
  /// Throws busy where so many more commands may not wait for the next tick.
  void CheckRoom(std::size_t commands) const;

 private:
  /// After a change of the models.
  void SetDefaults();
  void TakeIn(const JournalNews& news);
  /// The defaults with what the present preset sets.
  Parameters PresetValues() const;
  /// Puts parameters in an order in which the job can do with each step on the way: the control
  /// thread judges them one by one. Throws bad state where there is none.
  void OrderForJob(const JobRecord& job, std::vector<Command>* commands) const;
  /// Throws busy where so many commands cannot be taken, now or of one run.
  void CheckMayPost(std::size_t commands, std::size_t reserve) const;
  void TakeInNews();
  void TakeJobs();
  void TakeFrames();
  /// Tells of a recording that has ended by itself.
  void LookAfterRecorder();
  /// While recording: now and then a state to go on from.
  void SaveStateIfDue();
  /// An event of the daemon's own.
  void Tell(const char* kind, const std::string& text);
  void Keep(Json event);
  void MeasureSpeed();
  /// Writes the record of what led to `event` at once and has its picture drawn.
  void RecordIncident(const Event& event);
  void DrawIncidentLater(std::shared_ptr<const Incident> incident, std::filesystem::path picture);

  ServiceConfig config_;
  Host* host_;
  ControlLoop control_;
  JobTable jobs_;
  std::vector<JobRecord> ended_;               ///< taken from the control thread, not yet taken in
  std::vector<Published> frames_;              ///< taken, not yet shown
  std::vector<PublishedEvent> untold_events_;  ///< taken, their frame is not
  std::optional<JournalNews> untaken_;         ///< the same
  Journal journal_;
  std::uint64_t run_ = 0;
  std::map<std::uint64_t, std::function<void(const JournalNews&)>> marks_;
  std::multimap<std::uint64_t, std::function<void()>> after_taken_;
  const std::shared_ptr<ModelText> model_text_ = std::make_shared<ModelText>();
  Accepted accepted_;
  std::uint64_t accepted_changes_ = 0;
  std::shared_ptr<Recorder> recorder_;
  std::uint64_t recorder_changes_ = 0;
  History history_;
  std::deque<std::string> events_;
  std::vector<Sample> news_;                           ///< events since the last Drain()
  std::map<std::string, Sample, std::less<>> topics_;  ///< as Topic() gives them
  std::optional<StatusText> status_;
  std::uint64_t topics_made_ = 0;  ///< changes() as the topics have them
  std::shared_ptr<const Incident> incident_;
  std::uint64_t incidents_ = 0;
  Json incident_summary_;
  std::string incident_file_;  ///< the record of the last one; empty: it could not be written
  std::map<std::int64_t, Json> job_incidents_;  ///< summaries by job
  Published newest_;
  std::uint64_t frame_number_ = 0;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  struct SpeedSample {
    std::chrono::steady_clock::time_point wall;
    double time_s = 0;
    std::uint64_t run = 0;
  };
  std::optional<SpeedSample> sample_;  ///< since when time has gone on, of one run
  std::optional<double> real_time_factor_;
};

using Handler = Outcome (*)(Service&, const Params&, Client&);

/// The handler of a method, or null.
Handler FindHandler(std::string_view method);

/// Version of this build, "0.1.0".
std::string_view Version();

}  // namespace regrasp
