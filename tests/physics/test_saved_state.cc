// The whole state of a session, saved and loaded: to go on from any tick to the same bits, in
// another session; what is damaged or foreign is refused by name.

#include <gtest/gtest.h>
#include <malloc.h>

#include <map>
#include <optional>
#include <set>

#include "core/common/random.h"
#include "core/control/grasp_sequence.h"
#include "core/exploration/finger_exploration.h"
#include "core/gait/finger_gait.h"
#include "core/gait/object_move.h"
#include "core/journal/journal.h"
#include "core/journal/saved_state.h"
#include "core/sensing/sensors.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

constexpr int kTicks = 16000;

SessionConfig Config() {
  SessionConfig config = ShadowConfig(3);
  // Below 65 degrees of tilt the others make room before the thumb leaves.
  config.parameters.gravity_W = 9.81 * Vector3d(0, 0.42, -0.91);
  return config;
}

/// What is commanded before this tick: everything there is, some of it at the same time.
void Command(SessionRun* run, std::int64_t tick) {
  const auto rotate = [&](double angle) {
    run->Give(CommandType::kRotate, [angle](regrasp::Command* c) {
      c->angle_rad = angle;
      c->axis_W = {0, 0, -1};
    });
  };
  switch (tick) {
    case 100:
      run->Give(CommandType::kGrasp);
      break;
    case 2700:
      run->Explore(0, 5, 1500);
      break;
    case 3500:
      run->Give(CommandType::kNoise,
                [](regrasp::Command* c) { c->noise = NoisePreset("taxel").value(); });
      break;
    case 5000:
      run->Give(CommandType::kStop);
      break;
    case 6500:
      run->Give(CommandType::kNoise,
                [](regrasp::Command* c) { c->noise = NoisePreset("paper").value(); });
      run->Give(CommandType::kMove, [](regrasp::Command* c) { c->offset_W = {0.003, 0, 0.002}; });
      break;
    case 8000:
      rotate(1.0);
      break;
    case 9000:
      run->Push({0.2, 0, 0.1}, 0.3);
      break;
    case 12000:
      run->Give(CommandType::kStop);
      break;
    case 13000:
      run->Set("gait.mode", 1);
      rotate(0.5);
      break;
    case 15500:
      run->Give(CommandType::kStop);
      break;
    case 15700:
      run->Give(CommandType::kRelease);
      break;
    default:
      break;
  }
}

/// The run once, with its hashes, and the state at the ticks asked for.
struct Recorded {
  std::vector<std::uint64_t> hashes;  ///< before each tick and its commands
  std::map<std::int64_t, std::string> states;
  std::set<SessionState> seen;
};
const Recorded& TheRun() {
  static const Recorded recorded = [] {
    Recorded r;
    std::set<std::int64_t> ticks = {0, 101, 6700, 15800, kTicks - 1};
    RandomStream random(11, 0);
    while (ticks.size() < 24) ticks.insert(static_cast<std::int64_t>(kTicks * random.Uniform()));
    SessionRun run(Config());
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      r.hashes.push_back(run.session.StateHash());
      if (ticks.contains(tick)) {
        r.states[tick] = SaveState(run.session);
        r.seen.insert(run.session.state());
      }
      Command(&run, tick);
      run.Tick();
    }
    return r;
  }();
  return recorded;
}

TEST(SavedState, GoesOnToTheSameBits) {
  const Recorded& recorded = TheRun();
  for (const SessionState state :
       {SessionState::kGrasping, SessionState::kHolding, SessionState::kExploring,
        SessionState::kRotating, SessionState::kMoving, SessionState::kReleasing})
    EXPECT_TRUE(recorded.seen.contains(state)) << Name(state);
  // Not always a fresh one: what it did before, here and in the runs it went on with, leaves no
  // trace. Latest states first, which have felt the most of the object.
  SessionRun used(Config());
  ASSERT_TRUE(used.Grasp());
  used.Give(CommandType::kRotate, [](regrasp::Command* c) { c->angle_rad = 1.5; });
  used.Ticks(4000);
  ASSERT_EQ(used.session.state(), SessionState::kRotating);
  for (auto recorded_state = recorded.states.rbegin(); recorded_state != recorded.states.rend();
       ++recorded_state) {
    const auto& [from, state] = *recorded_state;
    std::optional<SessionRun> fresh;
    SessionRun& run = from % 2 == 0 ? used : fresh.emplace(Config());
    LoadState(state, &run.session);
    ASSERT_EQ(run.session.tick(), from);
    EXPECT_EQ(SaveState(run.session), state) << "tick " << from;
    for (std::int64_t tick = from; tick < std::min<std::int64_t>(kTicks, from + 1500); ++tick) {
      ASSERT_EQ(run.session.StateHash(), recorded.hashes[tick]) << tick << " from " << from;
      Command(&run, tick);
      run.Tick();
    }
  }
}

TEST(SavedState, IsOfAFewKilobytes) {
  for (const auto& [tick, state] : TheRun().states) EXPECT_LT(state.size(), 64u << 10) << tick;
}

/// Changes one number of all that it visits.
class Changer : public field_walk::Walk<Changer> {
 public:
  static constexpr bool kHashes = true, kLoads = false, kWrites = true;
  explicit Changer(int which) : Walk(5), which_(which) {}
  template <typename T>
  void Visit(const char* name, T& value, FieldRange) {
    if (count_++ != which_) return;
    changed_ = path_ + name;
    if constexpr (std::is_same_v<T, bool>) {
      value = !value;
    } else if constexpr (std::is_floating_point_v<T>) {
      value = value == 1 ? 0 : value + 1;  // also another flag or word
    } else {
      value = static_cast<T>(value ^ 1);
    }
  }
  const std::string& changed() const { return changed_; }
  int count() const { return count_; }

 private:
  friend class field_walk::Walk<Changer>;
  void Enter(const char* name) { path_ += std::string(name) + "."; }
  void Leave() { path_.resize(path_.rfind('.', path_.size() - 2) + 1); }
  int which_, count_ = 0;
  std::string path_, changed_;
};

template <typename T>
std::uint64_t HashOf(const T& object) {
  StateHasher hasher;
  HashFields(object, &hasher);
  return hasher.Digest();
}

/// Each number of `object` in turn. Returns the names of those changed.
template <typename T>
std::set<std::string> ChangeEach(const T& object) {
  const std::uint64_t before = HashOf(object);
  std::set<std::string> names;
  for (int which = 0;; ++which) {
    T copy = object;
    Changer changer(which);
    copy.Fields(changer);
    if (which >= changer.count()) return names;
    if (changer.changed().ends_with("size")) continue;  // not a number of its own
    EXPECT_NE(HashOf(copy), before) << changer.changed();
    names.insert(changer.changed());
  }
}

TEST(SavedState, EveryNumberThatActsIsHashed) {
  const HandModel hand = Config().model.hand;
  // What was once left out of the hash.
  const std::set<std::string> gait = ChangeEach(FingerGait());
  for (const char* name :
       {"home.p_WO.", "cycle.searches", "regrasp.request.slide.finger",
        "regrasp.request.slide.criterion", "regrasp.request.slide.seed", "table.sought"})
    EXPECT_TRUE(gait.contains(name)) << name;
  EXPECT_GT(gait.size(), 40u);
  EXPECT_GT(ChangeEach(FingerExploration()).size(), 30u);
  EXPECT_GT(ChangeEach(ObjectMove()).size(), 15u);
  EXPECT_GT(ChangeEach(GraspSequence()).size(), 3u);
  EXPECT_GT(ChangeEach(HybridController(hand, 1e-3)).size(), 10u);
  EXPECT_GT(ChangeEach(StateEstimator(hand, 1e-3)).size(), 5u);
  EXPECT_GT(ChangeEach(Sensors(hand, 1e-3, 1)).size(), 30u);
  EXPECT_GT(ChangeEach(Parameters()).size(), 90u);
  EXPECT_GT(ChangeEach(WorldMemory()).size(), 12u);
  EXPECT_GT(ChangeEach(FeltSurface()).size(), 0u);
}

// What nobody has set is what stood in the memory before.
TEST(SavedState, OfAFreshSessionDoesNotDependOnItsMemory) {
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the heap, however large: the system's pages are zero
  std::set<std::string> states;
  for (const int fill : {0x55, 0xaa, 0}) {
    ::mallopt(M_PERTURB, fill);
    states.insert(SaveState(*std::make_unique<Session>(Config())));
  }
  EXPECT_EQ(states.size(), 1u);
}

std::string Refusal(const std::string& state, const SessionConfig& config) {
  Session session(config);
  try {
    LoadState(state, &session);
  } catch (const StateError& error) {
    return error.what();
  }
  return "";
}

TEST(SavedState, ForeignOnesAreRefusedByName) {
  const std::string state = TheRun().states.begin()->second;
  SessionConfig config = Config();
  EXPECT_EQ(Refusal(state, config), "");
  config.model.object.name = "other";
  EXPECT_NE(Refusal(state, config).find("object is 'sphere'"), std::string::npos);
  config = Config();
  config.world.dt = 2e-3;
  EXPECT_NE(Refusal(state, config).find("time step"), std::string::npos);
  std::string other = state;
  const auto at = other.find(BuildIdentity());
  ASSERT_NE(at, std::string::npos);
  other[at] ^= 1;
  EXPECT_NE(Refusal(other, Config()).find("build is"), std::string::npos)
      << Refusal(other, Config());
  EXPECT_NE(Refusal("something else", Config()).find("saved state"), std::string::npos);
  EXPECT_NE(Refusal("", Config()).find("ends too early"), std::string::npos);
}

// Any byte of it: refused, or without effect (the number of the job, what is cut off from a word).
TEST(SavedState, DamagedOnesAreRefused) {
  const std::string state = TheRun().states.rbegin()->second;
  RandomStream random(12, 0);
  Session session(Config());
  LoadState(state, &session);
  const std::uint64_t hash = session.StateHash();
  int refused = 0;
  for (int k = 0; k < 400; ++k) {
    std::string damaged = state;
    const auto at = static_cast<std::size_t>(random.Uniform() * static_cast<double>(state.size()));
    if (k % 4 == 0)
      damaged.resize(at);
    else
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << (k % 8)));
    try {
      LoadState(damaged, &session);
      EXPECT_EQ(session.StateHash(), hash) << "byte " << at;
    } catch (const StateError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 380);
  LoadState(state, &session);  // what was refused has done no harm
  EXPECT_EQ(SaveState(session), state);
}

TEST(SavedState, AFaultedSessionHasNone) {
  SessionRun run(Config());
  run.Give(CommandType::kGrasp);
  run.Ticks(10);
  run.Set("gravity", Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  run.Ticks(1);
  ASSERT_EQ(run.session.state(), SessionState::kFaulted);
  EXPECT_EQ(SaveState(run.session), "");
}

TEST(SavedState, Base64IsItsOwnInverse) {
  std::string bytes;
  for (int k = 0; k < 300; ++k) {
    EXPECT_EQ(FromBase64(ToBase64(bytes)), bytes);
    bytes += static_cast<char>(k * 37);
  }
  EXPECT_EQ(ToBase64("Man"), "TWFu");  // RFC 4648
  EXPECT_EQ(ToBase64("Ma"), "TWE=");
  for (const char* bad : {"TWF", "TW=u", "T*Fu", "====", "TWE=TWFu"})
    EXPECT_THROW(FromBase64(bad), StateError) << bad;
}

}  // namespace
}  // namespace regrasp
