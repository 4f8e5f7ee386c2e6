#pragma once

/// The control thread: the only thread that touches the Session. Requests come in through a bounded
/// queue, frames, events and finished jobs leave through rings; no lock, future or callback goes
/// in.

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "core/journal/replay.h"
#include "core/protocol/start_words.h"
#include "core/session/session.h"
#include "daemon/loop/pacing.h"
#include "daemon/loop/ring.h"
#include "daemon/loop/tick_times.h"
#include "daemon/server/wake.h"

namespace regrasp {

/// What the I/O thread asks of the control thread.
struct ControlRequest {
  enum class Kind : std::uint8_t {
    kCommand,
    kPause,
    kResume,
    kStep,
    kCancelStep,  ///< ends a step or a restore
    kMark,        ///< tells tick and state hash, see JournalNews
    kRestore,
    kReset,  ///< a new session
  };
  /// kMark: what is told besides; it takes time of the control thread.
  enum class Part : std::uint8_t { kNothing, kState, kFelt };
  Kind kind = Kind::kCommand;
  Part part = Part::kNothing;
  Command command = {};         ///< kCommand; kRestore: the branch command (job, reseed, seed)
  std::int64_t job = 0;         ///< kStep, kCancelStep, kRestore
  std::int64_t ticks = 0;       ///< kStep
  bool until_job_ends = false;  ///< kStep: no further than that
  std::shared_ptr<const Checkpoint> checkpoint = {};  ///< kRestore
  /// kRestore: already in the checkpoint's state; null: its commands are executed again.
  std::unique_ptr<Session> session = {};
  std::uint64_t seed = 0;                          ///< kReset
  std::shared_ptr<const ObjectModel> object = {};  ///< kReset: the new one, null: the same
};

/// How a run began: at tick 0, or as the continuation of a checkpoint.
struct RunStart {
  Journal journal;  ///< up to the present
  bool restored = false;
  // In force now:
  Parameters parameters;
  NoiseLevels noise;
  std::uint64_t seed = 0;
};

/// What happens to the journal, in order; the I/O thread keeps it.
struct JournalNews {
  enum class Kind : std::uint8_t { kBegin, kCommand, kMark };
  Kind kind = Kind::kCommand;
  std::uint64_t run = 0;
  JournalEntry entry = {};                        ///< kCommand; kMark: tick and hash
  std::uint64_t request = 0;                      ///< kMark: number of the request
  JobRecord job = {};                             ///< kMark: the job that runs; id 0 = none
  SessionState state = {};                        ///< kMark
  std::shared_ptr<const std::string> saved = {};  ///< kMark with kState: SaveState()
  std::shared_ptr<const FeltSurface> felt = {};   ///< kMark with kFelt
  std::shared_ptr<const RunStart> start = {};     ///< kBegin
};

/// When simulated time advances by itself.
enum class ClockMode : std::uint8_t {
  kContinuous,  ///< always, unless paused
  kLockstep,    ///< while a job runs; what happens then depends on the commands alone
};
constexpr std::string_view ClockName(ClockMode clock) {
  return kClockWords[static_cast<std::size_t>(clock)];
}

/// One published tick.
struct Published {
  Frame frame;
  bool paused = false;
  bool advancing = false;    ///< simulated time goes on after this tick
  JobRecord step;            ///< the running or last step or restore; id 0 = none yet
  std::uint64_t run = 0;     ///< counts resets
  std::size_t commands = 0;  ///< of the run, applied before this state
  std::uint64_t number = 0;  ///< counts frames
};

/// An event, or a finished job, and the run it belongs to.
struct PublishedEvent {
  Event event;
  std::uint64_t run = 0;
  std::uint64_t frame = 0;  ///< Published::number of the first that shows it
};

struct ControlConfig {
  SessionConfig session;
  double speed = 1.0;  ///< times real time, or kMaxSpeed
  ClockMode clock = ClockMode::kContinuous;
  bool paused = false;  ///< begin paused
};

/// The parameters with which a reset begins: those in force, but mass and friction of a new object.
Parameters ParametersAfterReset(Parameters parameters, const ObjectModel* new_object);

/// Writes the value of a kParameter command. Its index and size have been checked.
void SetParameter(Parameters* parameters, const Command& command);

class ControlLoop {
 public:
  /// Builds the session (throws what Session throws) and starts the thread.
  explicit ControlLoop(ControlConfig config);
  /// Stops the thread and joins it.
  ~ControlLoop();

  // The I/O thread's side.

  /// Queues a request. Returns its number, or 0 when the queue is full. Commands take effect before
  /// the next tick, in order, and where time stands still in lockstep at once: at the tick where
  /// the last job ended. A reset takes effect at once, even while paused.
  std::uint64_t Post(ControlRequest request);
  /// Requests up to this number have been taken: applied, or (while paused) waiting for the next
  /// tick. A frame that shows their effect has been published before.
  std::uint64_t acknowledged() const { return acknowledged_.load(std::memory_order_acquire); }
  /// Commands that wait for the next tick or are still queued.
  std::size_t backlog() const {
    return requests_.size() + waiting_.load(std::memory_order_relaxed);
  }
  bool PopFrame(Published* frame) { return frames_.Pop(frame); }
  bool PopEvent(PublishedEvent* event) { return events_.Pop(event); }
  bool PopJob(JobRecord* job) { return jobs_.Pop(job); }
  bool PopNews(JournalNews* news) { return news_.Pop(news); }
  /// 99th percentile of how long after their due time the last ticks began [s]; 0 at full speed.
  double lateness_p99() const { return lateness_.p99(); }
  /// Grows with every tick, and while the clock is stopped on purpose with every Nudge(): a loop
  /// that is stuck, or has faulted, does not move it.
  std::uint64_t pulse() const { return pulse_.load(std::memory_order_relaxed); }
  /// Any thread: makes a sleeping loop look around once.
  void Nudge() { input_.Notify(); }
  /// Frames and events lost because the rings were full; none in lockstep.
  std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }
  /// 99th percentile of the time that the last ticks took [s].
  double tick_p99() const { return tick_times_.p99(); }
  /// Notified when a frame, an event, a job or an acknowledgement is there.
  Wake& output() { return output_; }

 private:
  struct Waiting {
    ControlRequest request;
    std::uint64_t number = 0;
  };

  void Run();
  bool Advancing() const;
  void StandStill();
  void TakeRequests();
  void ApplyWaiting();
  void Reset(const ControlRequest& request);
  /// Ends the jobs whose commands wait: that of `id`, or all where it is 0.
  void CancelWaiting(std::int64_t id, const char* why);
  void CancelEverything(const char* why);
  void BeginRestore(ControlRequest request);
  void RestoreSome();
  void Adopt(std::unique_ptr<Session> session);
  void EndRestore(JobState state, const char* error);
  /// Tells the end of a job that no session ends.
  JobRecord EndJob(JobRecord job, JobState state, const char* why);
  void Apply(const Command& command);
  void Mark(std::uint64_t request, ControlRequest::Part part);
  void BeginJournal(std::shared_ptr<const RunStart> start);
  void EmitNews(JournalNews news);
  void TickOnce();
  void FinishStep(JobState state, const char* error);
  void EmitJob(const JobRecord& job);
  void EmitEvent(const Event& event);
  /// Whether the ring has taken it. In lockstep it is waited for: what is told depends on the
  /// commands, not on how soon it is fetched.
  template <typename Queue, typename T>
  bool Put(Queue* ring, const T& value);
  void CollectOutput();
  void Publish();
  void Acknowledge();

  ControlConfig config_;
  std::unique_ptr<Session> session_;
  Pacing pacing_;
  bool paused_ = false;
  std::int64_t steps_left_ = 0, steps_total_ = 0;
  bool step_until_job_ends_ = false;
  JobRecord step_;
  ControlRequest restoring_;        ///< while replay_ is there
  std::unique_ptr<Replay> replay_;  ///< on its way to the checkpoint; the session stands still
  std::uint64_t run_ = 0;
  std::uint64_t frames_published_ = 0;
  std::size_t applied_ = 0;               ///< commands of the run
  std::vector<Waiting> commands_;         ///< taken, to be applied before the next tick
  std::vector<JobRecord> unsent_jobs_;    ///< ended; their frame or the ring had no room yet
  std::vector<JournalNews> unsent_news_;  ///< likewise
  std::uint64_t taken_ = 0;               ///< number of the last request taken
  bool publish_due_ = true;               ///< something changed that the last frame does not show
  Published scratch_;
  TickTimes tick_times_, lateness_;

  std::uint64_t posted_ = 0;  // I/O thread
  Ring<Waiting, 512> requests_;
  Ring<Published, 128> frames_;
  Ring<PublishedEvent, 1024> events_;
  Ring<JobRecord, 256> jobs_;
  Ring<JournalNews, 1024> news_;
  std::atomic<std::uint64_t> acknowledged_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> pulse_{0};
  std::atomic<std::size_t> waiting_{0};
  std::atomic<bool> stopping_{false};
  Wake input_, output_;
  std::thread thread_;
};

}  // namespace regrasp
