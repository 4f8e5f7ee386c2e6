// The conclusions of an incident, from made-up frames.

#include <gtest/gtest.h>

#include <cstdio>

#include "daemon/output/incident.h"
#include "snapshots/plots.h"
#include "tests/unit/snapshots/synthetic_run.h"

namespace regrasp {
namespace {

constexpr int kDropTick = 5004;

Event EventAt(std::int64_t tick, EventKind kind, const char* text) {
  Event event;
  event.tick = tick;
  event.kind = kind;
  std::snprintf(event.text, sizeof event.text, "%s", text);
  return event;
}

/// Three fingers hold for six seconds at 100 Hz; the drop is at tick 5004.
class IncidentRecord : public ::testing::Test {
 protected:
  IncidentRecord() {
    const Frame one = SyntheticRun(1).back();
    for (int tick = 0; tick <= 6000; tick += 10) {
      frames.push_back(one);
      frames.back().tick = tick;
      frames.back().time_s = 1e-3 * tick;
      frames.back().state = tick > kDropTick ? SessionState::kDropped : SessionState::kHolding;
    }
    source.event = EventAt(kDropTick, EventKind::kDropped, "dropped");
    source.object = "sphere";
  }
  /// From `from` to before `to`, the finger does not touch.
  void Off(int finger, int from, int to = 6001) {
    for (Frame& frame : frames)
      if (frame.tick >= from && frame.tick < to) frame.fingers[finger].true_contact = false;
  }
  Incident Make() {
    for (const Frame& frame : frames) source.frames.push_back(std::make_shared<const Frame>(frame));
    return MakeIncident(source, hand);
  }
  bool Says(const Incident& incident, const std::string& text) {
    return incident.cause.find(text) != std::string::npos;
  }
  const HandModel hand = SyntheticHand();
  std::vector<Frame> frames;
  IncidentSource source;
};

TEST_F(IncidentRecord, HoldsTheTwoSecondsBeforeTheEvent) {
  source.events = {EventAt(3003, EventKind::kPush, "too early"),
                   EventAt(3004, EventKind::kPush, "push"), source.event,
                   EventAt(5005, EventKind::kPush, "too late")};
  const Incident incident = Make();
  ASSERT_EQ(incident.frames.size(), 200u);
  EXPECT_EQ(incident.frames.front()->tick, 3010);
  EXPECT_EQ(incident.frames.back()->tick, 5000);
  ASSERT_EQ(incident.events.size(), 2u);
  ASSERT_EQ(incident.disturbances.size(), 1u);
  EXPECT_TRUE(Says(incident, "push began 2.00 s before")) << incident.cause;
}

TEST_F(IncidentRecord, NamesTheFingerThatLetGoFirst) {
  Off(2, 4800);
  Off(0, 4700);
  Off(0, 4000, 4100);  // came back
  const Incident incident = Make();
  ASSERT_EQ(incident.ends.size(), 2u);
  EXPECT_EQ(incident.ends[0].finger, 0);
  EXPECT_DOUBLE_EQ(incident.ends[0].time_s, 4.69);
  EXPECT_EQ(incident.ends[1].finger, 2);
  EXPECT_TRUE(Says(incident, "one lost its contact first, 0.31 s before")) << incident.cause;
  EXPECT_TRUE(Says(incident, "no push and no change of parameters")) << incident.cause;
}

TEST_F(IncidentRecord, FingersThatLetGoTogetherAreNamedTogether) {
  Off(1, 4700);
  Off(2, 4700);
  EXPECT_TRUE(Says(Make(), "two and three lost their contacts first, 0.31 s before"));
}

TEST_F(IncidentRecord, ADropWithAllContactsIsSaid) {
  const Incident incident = Make();
  EXPECT_TRUE(incident.ends.empty());
  EXPECT_TRUE(Says(incident, "no holding finger lost its contact")) << incident.cause;
}

TEST_F(IncidentRecord, ABrushOfTheFallingObjectIsNoContact) {
  Off(0, 4700);
  for (const int tick : {4900, 4910}) frames[tick / 10].fingers[0].true_contact = true;
  Off(1, 4800);
  EXPECT_EQ(Make().ends[0].finger, 0);
}

TEST_F(IncidentRecord, AFingerThatRegraspsHasNotLostItsContact) {
  for (Frame& frame : frames) {
    frame.state = frame.tick > kDropTick ? SessionState::kDropped : SessionState::kRotating;
    frame.gait.active = true;
    frame.gait.finger = frame.tick >= 4600 ? 1 : -1;
  }
  Off(1, 4650);
  Off(2, 4700);
  const Incident incident = Make();
  EXPECT_TRUE(incident.ends[0].lifted);
  EXPECT_EQ(incident.lifted, 1);
  EXPECT_TRUE(Says(incident, "rotating, two off the object to regrasp")) << incident.cause;
  EXPECT_TRUE(Says(incident, "three lost its contact first")) << incident.cause;
}

TEST_F(IncidentRecord, TheLoadMarginCountsUntilTheFirstContactIsLost) {
  Off(2, 4700);
  frames[450].stability.load_margin = 0.04;
  frames[480].stability.load_margin = 0.01;  // a consequence
  const Incident incident = Make();
  EXPECT_DOUBLE_EQ(incident.least_margin, 0.04);
  EXPECT_DOUBLE_EQ(incident.least_margin_s, 4.5);
  EXPECT_TRUE(Says(incident, "down to 0.04 N, below the limit of 0.25 N")) << incident.cause;
}

TEST_F(IncidentRecord, FrictionBelowWhatControlCountsOnIsSaid) {
  EXPECT_FALSE(Says(Make(), "counts on"));
  for (Frame& frame : frames) {
    frame.friction = 0.2;
    frame.friction_counted = 0.37;  // as it was felt
  }
  source.frames.clear();
  EXPECT_TRUE(Says(Make(), "Friction was 0.2, where control counts on 0.37"));
}

// It leans on another finger, say. What slips in the last tenth of a second presses less, too.
TEST_F(IncidentRecord, AFingerThatPressesFarLessThanAskedIsNamed) {
  Off(2, 4700);
  for (Frame& frame : frames)
    for (FingerFrame& finger : frame.fingers) {
      finger.role = FingerRole::kHold;
      finger.f_command_W = Vector3d(0, 0, 2);
      finger.true_force_W = Vector3d(0, 0, frame.tick > 4600 ? 0.1 : 1.9);
    }
  const auto make = [&] {
    source.frames.clear();
    return Make();
  };
  EXPECT_FALSE(Says(make(), "asked for"));
  for (Frame& frame : frames) frame.fingers[1].true_force_W = Vector3d(0, 0.8, 0);
  const Incident incident = make();
  EXPECT_TRUE(Says(incident, " two pressed with 0.8 N where 2.0 N were asked for."))
      << incident.cause;
  const Json weak = IncidentJson(incident, hand)["findings"]["weak_fingers"];
  ASSERT_EQ(weak.size(), 1u);
  EXPECT_EQ(weak[0]["finger"], "two");
  EXPECT_NEAR(weak[0]["force_n"].get<double>(), 0.8, 1e-9);
  EXPECT_NEAR(weak[0]["asked_n"].get<double>(), 2, 1e-9);
  for (Frame& frame : frames) frame.fingers[1].role = FingerRole::kMove;
  EXPECT_FALSE(Says(make(), "asked for"));
}

TEST_F(IncidentRecord, BeforeTheFingersHoldTheObjectHasNoPlaceToBeOff) {
  for (Frame& frame : frames)
    if (frame.tick < 4000) {
      frame.state = SessionState::kGrasping;
      frame.stand_in = true;
    }
  const Json error = IncidentJson(Make(), hand)["samples"]["object_error_m"];
  EXPECT_TRUE(error.front().is_null());
  EXPECT_TRUE(error.back().is_number());
}

TEST_F(IncidentRecord, NamesWhatDiffersFromTheDefaults) {
  EXPECT_EQ(IncidentJson(Make(), hand)["changed_parameters"], Json::object());
  source.changed = {{"gait.step_rad", 0.3}};
  source.changed_text = "gait.step_rad = 0.3";
  const Incident incident = Make();
  EXPECT_EQ(IncidentJson(incident, hand)["changed_parameters"], source.changed);
  EXPECT_EQ(PictureOf(incident, hand).options.changed, "gait.step_rad = 0.3");
}

TEST_F(IncidentRecord, AFaultHasOneToo) {
  source.event = EventAt(kDropTick, EventKind::kFault, "simulation fault: not finite");
  const Incident incident = Make();
  EXPECT_TRUE(Says(incident, "simulation fault: not finite")) << incident.cause;
  EXPECT_EQ(IncidentJson(incident, hand)["kind"], "fault");
}

TEST_F(IncidentRecord, NothingKnownIsSaid) {
  const Incident incident = MakeIncident(source, hand);
  EXPECT_TRUE(Says(incident, "nothing is known")) << incident.cause;
  EXPECT_TRUE(IncidentJson(incident, hand)["samples"]["tick"].empty());
}

TEST_F(IncidentRecord, TheJobIsTheOneThatTheEventEnded) {
  source.job.id = 3;
  source.job.state = JobState::kDone;
  source.job.end_tick = 2000;
  EXPECT_EQ(Make().job.id, 0);
  source.job.end_tick = kDropTick;
  EXPECT_EQ(Make().job.id, 3);
}

}  // namespace
}  // namespace regrasp
