// What a run file says is false until it is checked.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/journal/checked_json.h"
#include "core/journal/journal_text.h"
#include "core/journal/provenance.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

using Json = nlohmann::ordered_json;

const SessionConfig& Config() {
  static const SessionConfig config = [] {
    SessionConfig c;
    c.model = LoadScenario("shadow", "egg", ModelSearchPath());
    c.parameters = DefaultParameters(c.model);
    return c;
  }();
  return config;
}

/// The message that a configuration is refused with once `spoil` has changed it; "" when it is
/// taken.
std::string Refusal(const std::function<void(Json&)>& spoil,
                    const SessionConfig& config = Config()) {
  Json json = Json::parse(ConfigText(config, 0));
  spoil(json);
  try {
    ParseConfig(json.dump());
  } catch (const JournalError& e) {
    return e.what();
  }
  return "";
}

TEST(Check, TakesEveryModelOfOurs) {
  for (const std::string& object : ListObjects(ModelSearchPath())) {
    SessionConfig config = Config();
    config.model = LoadScenario("shadow", object, ModelSearchPath());
    config.parameters = DefaultParameters(config.model);
    EXPECT_NO_THROW(ParseConfig(ConfigText(config, 0))) << object;
  }
}

TEST(Check, ACapsuleOfAFormerVersionIsNamed) {
  const std::string refusal =
      Refusal([](Json& json) { json["/model/object/kind"_json_pointer] = 2; });
  EXPECT_NE(refusal.find("capsule"), std::string::npos) << refusal;
}

struct Spoilt {
  const char* where;  ///< a JSON pointer to a number
  std::vector<double> values;
};

void ExpectEachRefused(const std::vector<Spoilt>& cases, const SessionConfig& config) {
  for (const Spoilt& spoilt : cases)
    for (const double value : spoilt.values) {
      const auto spoil = [&](Json& json) {
        const Json::json_pointer place(spoilt.where);
        ASSERT_TRUE(json.contains(place)) << spoilt.where;
        json[place] = value == std::floor(value) && std::abs(value) < 1e15
                          ? Json(static_cast<std::int64_t>(value))
                          : Json(value);
      };
      EXPECT_NE(Refusal(spoil, config), "") << spoilt.where << " = " << value;
    }
}

TEST(Check, RefusesEveryIndexThatIsNone) {
  ExpectEachRefused(
      {
          {"/model/hand/links/3/parent_joint", {-1, 1000, 4294967296.0, 1e300, 0.5}},
          {"/model/hand/joints/3/child_link", {0, -1, 99999, 4294967297.0}},
          {"/model/hand/joints/3/parent_link", {-1, 30, 99999}},
          {"/model/hand/fingers/0/tip_link", {-7, 0, 33, 99999}},
          {"/model/hand/fingers/0/joints/0", {-1, 99, 1}},
          {"/model/hand/links/0/parent_joint", {0}},
          {"/model/object/kind", {-1, 9, 259}},
          {"/world/stepper", {-1, 3, 256}},
          {"/world/dt_s", {0, -1, 1e-300, 1}},
          {"/model/object/mass", {0, -1, 1e9}},
          {"/model/object/friction", {-0.1, 1.1}},
      },
      Config());
}

class CheckCoupled : public LoaderTest {
 protected:
  /// Joint 1 of this hand follows joint 0.
  SessionConfig MimicConfig() {
    Write("hands/mini.urdf", Replaced(kHandUrdf, "<limit lower=\"-0.5\" upper=\"1.5\"",
                                      "<mimic joint=\"A\" multiplier=\"0.5\" offset=\"0.1\"/>"
                                      "<limit lower=\"-0.5\" upper=\"0.6\""));
    Write("hands/mini.toml",
          Replaced(Replaced(kScenarioToml, "B = 20.5\n", ""), "A = 60\nB = 70\n", "A = 57\n"));
    SessionConfig config;
    config.model = Load();
    config.parameters = DefaultParameters(config.model);
    return config;
  }
};

TEST_F(CheckCoupled, AHandWithMimicIsTakenAndComesBackWhole) {
  const SessionConfig config = MimicConfig();
  ASSERT_EQ(config.model.hand.num_coupled, 1);
  const std::string text = ConfigText(config, 0);
  const SessionConfig back = ParseConfig(text).config;
  EXPECT_EQ(back.model.hand.num_coupled, 1);
  EXPECT_EQ(back.model.hand.joints[1].driver, 0);
  EXPECT_EQ(back.model.hand.joints[1].ratio, 0.5);
  EXPECT_EQ(back.model.hand.joints[1].offset, 0.1);
  EXPECT_EQ(ConfigText(back, 0), text);
}

TEST_F(CheckCoupled, ACouplingThatIsNoneIsRefused) {
  const std::vector<Spoilt> cases = {
      {"/model/hand/joints/1/driver", {9999, 1, -1, -2}},
      {"/model/hand/joints/1/ratio", {0, 1e-4, 101, -1e300}},
      {"/model/hand/joints/1/offset", {1e4, -1e300}},
      // A driven joint follows none.
      {"/model/hand/joints/0/driver", {0, 9999, -2}},
      {"/model/hand/joints/0/ratio", {0.5, -1}},
      {"/model/hand/joints/0/offset", {0.1}},
      {"/model/hand/num_coupled", {-1, 0, 2, 3, 2147483647}},
  };
  ExpectEachRefused(cases, MimicConfig());
}

TEST(Check, RefusesTrianglesOfNoVertices) {
  SessionConfig config = Config();
  for (const int bad : {-1, 1'000'000'000}) {
    const std::string refusal = Refusal([&](Json& json) {
      json["model"]["object"]["kind"] = static_cast<int>(ObjectModel::Kind::kMesh);
      json["model"]["object"]["vertices_O"] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      json["model"]["object"]["triangles"] = {{0, 1, bad}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}};
    });
    EXPECT_NE(refusal.find("triangles"), std::string::npos) << refusal;
  }
}

TEST(Check, RefusesSizesThatNothingHas) {
  EXPECT_NE(Refusal([](Json& json) {
              Json& fingers = json["model"]["hand"]["fingers"];
              const Json five = fingers;
              for (int i = 0; i < 3; ++i)
                for (const Json& finger : five) fingers.push_back(finger);
            }),
            "");
  EXPECT_NE(Refusal([](Json& json) { json["model"]["hand"]["links"] = Json::array(); }), "");
  EXPECT_NE(Refusal([](Json& json) { json["model"]["hand"]["joints"] = Json::array(); }), "");
  EXPECT_NE(Refusal([](Json& json) { json["model"]["scenario"]["q_closed"] = {0.1, 0.2}; }), "");
  EXPECT_NE(Refusal([](Json& json) { json["model"]["hand"]["links"] = 3; }), "");
}

TEST(Check, RefusesNamesThatAreNone) {
  for (const char* name : {"", "a\nb", "\x1b[2J", "\xe2\x80\xae"})
    for (const char* where : {"/model/hand/name", "/model/hand/fingers/0/name",
                              "/model/hand/joints/0/name", "/model/object/name"})
      EXPECT_NE(Refusal([&](Json& json) { json[Json::json_pointer(where)] = name; }), "") << where;
}

TEST(Check, RefusesWhatNoCommandCouldBe) {
  const auto refused = [](const char* method, const Json& fields) {
    Json json = {{"segment", 0},
                 {"seq", 0},
                 {"tick", 5},
                 {"method", method},
                 {"state_hash", "0000000000000000"},
                 {"job", 1}};
    json.update(fields);
    try {
      ParseEntry(json.dump(), Config());
    } catch (const JournalError&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused("grasp", Json::object()));
  EXPECT_TRUE(refused("grasp", {{"tick", -1}}));
  EXPECT_TRUE(refused("grasp", {{"tick", 1e17}}));
  EXPECT_TRUE(refused("grasp", {{"job", -1}}));
  EXPECT_TRUE(refused("push", {{"force_W_n", {0, 0, 1e9}}, {"duration_s", 0.1}}));
  EXPECT_TRUE(refused("push", {{"force_W_n", {0, 0, 1}}, {"duration_s", -1}}));
  EXPECT_TRUE(refused("param.set", {{"name", "object.friction"}, {"value", {7, 0, 0}}}));
  EXPECT_TRUE(refused(
      "explore",
      {{"finger", "nose"}, {"criterion", 0}, {"estimator", 0}, {"seed", 1}, {"max_cycles", 0}}));
}

TEST(FileJson, RefusesWhatTheLibraryWouldTake) {
  EXPECT_NO_THROW(ParseFileJson(R"({"a":[1,{"b":"[[[["}]})"));
  EXPECT_THROW(ParseFileJson(std::string("{}\0{}", 5)), JournalError);
  EXPECT_THROW(ParseFileJson(std::string(200'000, '[')), JournalError);
  EXPECT_THROW(ParseFileJson(std::string(200'000, '[') + std::string(200'000, ']')), JournalError);
  EXPECT_THROW(ParseFileJson("\"\xff\""), JournalError);
}

TEST(Provenance, NamesWhatDiffers) {
  SessionConfig config = Config();
  EXPECT_TRUE(Differences(config, BuildIdentity(), ModelSearchPath()).empty());
  config.parameters.object.friction = 0.3;
  config.model.object.mass *= 2;
  const auto found = Differences(config, "0.0.1 another", ModelSearchPath());
  ASSERT_GE(found.size(), 3u);
  EXPECT_NE(found[0].find("0.0.1 another"), std::string::npos);
  EXPECT_NE(found[1].find("object 'egg'"), std::string::npos) << found[1];
  bool friction = false;
  for (const std::string& text : found)
    friction = friction || text.find("object.friction = 0.3") != std::string::npos;
  EXPECT_TRUE(friction);
}

}  // namespace
}  // namespace regrasp
