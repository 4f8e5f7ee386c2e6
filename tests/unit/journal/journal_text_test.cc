// Journals as text: every bit comes back.

#include "core/journal/journal_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/journal/replay.h"
#include "core/journal/run_messages.h"

namespace regrasp {
namespace {

SessionConfig Config(const std::string& object) {
  SessionConfig config;
  config.model = LoadScenario("shadow", object, ModelSearchPath());
  config.parameters = DefaultParameters(config.model);
  config.noise = *NoisePreset("taxel");
  config.seed = 18446744073709551615u;
  config.world.contact_damping = 8.1;
  return config;
}

TEST(JournalText, AConfigurationGivesTheSameSession) {
  for (const std::string object : {"sphere", "egg"}) {
    SessionConfig config = Config(object);
    // Values whose decimal form is long.
    config.parameters.object.mass_kg = 0.1 + 0.2;
    config.parameters.gravity_W = Vector3d(1e-300, -0.0, -9.81 / 3);
    const ConfigRead read = ParseConfig(ConfigText(config, 4));
    EXPECT_EQ(read.segment, 4);
    EXPECT_EQ(read.build, BuildIdentity());
    EXPECT_EQ(ConfigText(read.config, 4), ConfigText(config, 4));
    Session original(config), copy(read.config);
    for (int i = 0; i < 50; ++i) {
      original.Tick();
      copy.Tick();
    }
    EXPECT_EQ(original.StateHash(), copy.StateHash()) << object;
  }
}

TEST(JournalText, AKnownModelIsNeitherWrittenNorReadAnew) {
  const SessionConfig egg = Config("egg"), sphere = Config("sphere");
  ModelText known;
  for (const SessionConfig* config : {&egg, &egg, &sphere, &egg}) {
    const std::string text = ConfigText(*config, 0, &known);
    EXPECT_EQ(text, ConfigText(*config, 0));
    ASSERT_TRUE(known.Without(text));
    EXPECT_EQ(ConfigText(ParseConfig(text, &known).config, 0), text);
  }
  // Of another model by one bit, in the middle.
  SessionConfig other = egg;
  double& x = other.model.object.vertices_O[other.model.object.vertices_O.size() / 2].x();
  x = std::nextafter(x, 1.0);
  const std::string text = ConfigText(other, 0);
  EXPECT_FALSE(known.Without(text));
  EXPECT_EQ(ConfigText(ParseConfig(text, &known).config, 0), text);
  EXPECT_TRUE(known.Without(text));
  EXPECT_EQ(ConfigText(egg, 0, &known), ConfigText(egg, 0));
}

TEST(JournalText, WhatOnlyLooksLikeAKnownModelIsRefused) {
  const SessionConfig sphere = Config("sphere");
  ModelText known;
  const std::string text = ConfigText(sphere, 0, &known), model = known.Of(sphere.model);
  // In a text, in an object that does not end, after what is no JSON.
  for (const char* before : {R"({"a":"b)", R"({"format":"regrasp-run/2","a":{"b":1)", R"({"a":})"})
    EXPECT_THROW(ParseConfig(before + (R"(,"model":)" + model) + "}", &known), JournalError)
        << before;
  // Known is not yet good: a seed below 0.
  std::string spoilt = text;
  const auto seed = spoilt.find(R"("seed":)");
  spoilt.insert(seed + 7, "-");
  EXPECT_THROW(ParseConfig(spoilt, &known), JournalError);
}

// What is not in the list is in no schema and no table of an export.
TEST(JournalText, WhateverACommandHasIsAFieldOfRunFiles) {
  const SessionConfig config = Config("sphere");
  const std::string table = RunFieldTable();
  for (int type = 0; type <= static_cast<int>(CommandType::kBranch); ++type) {
    JournalEntry entry;
    entry.command.type = static_cast<CommandType>(type);
    entry.command.finger = 0;
    const auto json = nlohmann::json::parse(EntryText(entry, config, 0, 0));
    for (const auto& [key, value] : json.items())
      EXPECT_NE(table.find("| `commands` | `" + key + "` |"), std::string::npos)
          << key << " of " << json["method"];
  }
}

TEST(JournalText, HandsDifferByOneBit) {
  const HandModel hand = Config("sphere").model.hand;
  EXPECT_EQ(HandBytes(hand), HandBytes(HandModel(hand)));
  HandModel other = hand;
  double& mass = other.links.back().mass;
  mass = std::nextafter(mass, 1.0);
  EXPECT_NE(HandBytes(hand), HandBytes(other));
  other = hand;
  std::swap(other.fingers[0].name, other.fingers[1].name);
  EXPECT_NE(HandBytes(hand), HandBytes(other));
}

// Until format 2 vertices and triangles were lists in a list.
TEST(JournalText, AConfigurationOfTheFormerFormatIsRead) {
  const SessionConfig config = Config("egg");
  auto json = nlohmann::ordered_json::parse(ConfigText(config, 0));
  json["format"] = "regrasp-run/1";
  auto& object = json.at("model").at("object");
  for (const char* key : {"vertices_O", "triangles"}) {
    const auto flat = object.at(key);
    ASSERT_GT(flat.size(), 30u);
    object[key] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < flat.size(); i += 3)
      object[key].push_back({flat[i], flat[i + 1], flat[i + 2]});
  }
  EXPECT_EQ(ConfigText(ParseConfig(json.dump()).config, 0), ConfigText(config, 0));
}

/// Converts to a member of any scalar type: T{Any(), ...} with as many of them as T has members is
/// the longest that compiles.
struct Any {
  template <typename T>
  requires(std::is_scalar_v<T> || std::is_same_v<T, Vector3d>) operator T() const;
};
template <typename T, typename... Members>
constexpr int CountMembers() {
  if constexpr (requires { T{Members()..., Any()}; })
    return CountMembers<T, Members..., Any>();
  else
    return sizeof...(Members);
}

// A member that is not in the parameter table would be lost.
TEST(JournalText, TheParameterTableHoldsEveryParameter) {
  constexpr int kMembers = CountMembers<ObjectParameters>() + CountMembers<StartParameters>() +
                           CountMembers<ControlParameters>() +
                           CountMembers<ExplorationParameters>() + CountMembers<GaitParameters>() +
                           CountMembers<ShapeParameters>();
  constexpr int kGravity = 1;
  EXPECT_EQ(ParameterTable().size(), static_cast<std::size_t>(kMembers + kGravity));
}

TEST(JournalText, WordsAndBooleansAreReadAsNumbersToo) {
  SessionConfig config = Config("sphere");
  config.parameters.gait.mode = GaitMode::kExploring;
  config.parameters.gait.hop = false;
  std::string text = ConfigText(config, 0);
  const auto replace = [&text](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace(R"("gait.mode":"exploring")", R"("gait.mode":[0.0])");
  replace(R"("gait.hop":false)", R"("gait.hop":[0.0])");
  EXPECT_EQ(ConfigText(ParseConfig(text).config, 0), ConfigText(config, 0));
  replace(R"("gait.mode":[0.0])", R"("gait.mode":"explorin")");
  EXPECT_THROW(ParseConfig(text), JournalError);
}

TEST(JournalText, EveryCommandComesBack) {
  const SessionConfig config = Config("sphere");
  std::size_t seq = 0;
  for (const CommandType type :
       {CommandType::kGrasp, CommandType::kRelease, CommandType::kExplore, CommandType::kRotate,
        CommandType::kMove, CommandType::kStop, CommandType::kNoise, CommandType::kPush,
        CommandType::kParameter, CommandType::kCancelJob, CommandType::kBranch}) {
    JournalEntry entry;
    entry.tick = 12345;
    entry.state_hash = 0x00ab;
    Command& c = entry.command;
    c.type = type;
    c.job = 7;
    c.finger = 3;
    c.criterion = Criterion::kSwitched;
    c.estimator = Estimator::kSecant;
    c.seed = 1ull << 60;
    c.max_cycles = 99;
    c.continuous = true;
    c.angle_rad = -0.1;
    c.axis_W = Vector3d(0.6, 0, -0.8);
    c.speed_rad_s = 1.0 / 3;
    c.offset_W = Vector3d(0.001, -0.002, 1.0 / 300);
    c.rotation_W = Vector3d(-0.1, 0.2, 1.0 / 7);
    c.noise = *NoisePreset("coarse");
    c.force_W = Vector3d(0.1, 0.2, 0.3);
    c.duration_s = 0.7;
    c.parameter = FindParameter("gravity");
    c.value = Vector3d(1.1, 2.2, -3.3);
    c.reseed = true;
    const std::string text = EntryText(entry, config, 2, seq);
    const EntryRead read = ParseEntry(text, config);
    EXPECT_EQ(read.entry.command.type, type) << text;
    EXPECT_EQ(read.segment, 2);
    EXPECT_EQ(read.seq, seq);
    EXPECT_EQ(EntryText(read.entry, config, 2, seq), text);
    ++seq;
  }
  JournalEntry explore;
  explore.tick = 1;
  explore.command.type = CommandType::kExplore;
  explore.command.finger = 3;
  EXPECT_EQ(ParseEntry(EntryText(explore, config, 0, 0), config).entry.command.finger, 3);
}

TEST(JournalText, TellsWhatIsWrong) {
  const SessionConfig config = Config("sphere");
  const auto message = [&](const std::string& text) -> std::string {
    try {
      ParseEntry(text, config);
    } catch (const JournalError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("{").find("not JSON"), std::string::npos);
  EXPECT_NE(message("{}").find("segment is missing"), std::string::npos);
  EXPECT_NE(message(R"({"segment":"x"})").find("segment: an integer is expected"),
            std::string::npos);
  EXPECT_NE(
      message(R"({"segment":0,"seq":0,"tick":0,"method":"fly","state_hash":"0000000000000000"})")
          .find("unknown method 'fly'"),
      std::string::npos);
  EXPECT_THROW(ParseConfig(R"({"format":"regrasp-run/2"})"), JournalError);
  EXPECT_THROW(ParseConfig(R"({"format":"regrasp-run/3"})"), JournalError);
}

}  // namespace
}  // namespace regrasp
