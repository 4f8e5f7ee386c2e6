#include "core/quality/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "core/quality/epsilon.h"
#include "core/quality/evaluate_json.h"
#include "core/quality/load_margin.h"
#include "core/quality/stability.h"
#include "tests/unit/quality/grasps.h"

namespace regrasp {
namespace {

using namespace test;
using nlohmann::json;

json File(const Contacts& contacts) {
  json file = {{"torque_scale_m", 0.025}, {"cone_edges", 8}, {"contacts", json::array()}};
  for (const GraspContact& c : contacts)
    file["contacts"].push_back(
        {{"position_m", {c.position.x(), c.position.y(), c.position.z()}},
         {"normal", {c.inward_normal.x(), c.inward_normal.y(), c.inward_normal.z()}},
         {"mu", c.mu}});
  return file;
}

TEST(EvaluateJson, GivesEveryMeasureOfTheLibrary) {
  const Contacts contacts = Tetrahedron(0.025, 0.5);
  json file = File(contacts);
  file["weight_n"] = {0, 0, -0.785};
  file["max_force_n"] = 4;
  const json out = json::parse(EvaluateJson(file.dump()));
  // Numbers pass through text in both directions without loss; normals are normalised once more.
  EXPECT_NEAR(out["epsilon"], EpsilonSolver().Compute(contacts, 0.025, 8), 1e-14);
  EXPECT_NEAR(out["volume"], WrenchHullVolume(contacts, 0.025, 8), 1e-12);
  EXPECT_NEAR(out["min_singular_value"], std::sqrt(8.0 / 3), 1e-12);
  EXPECT_NEAR(out["isotropy"], std::sqrt(2.0 / 3), 1e-12);
  EXPECT_NEAR(out["sqrt_det"], std::pow(32.0 / 3, 1.5), 1e-10);
  EXPECT_EQ(out["force_closure"], true);
  EXPECT_NEAR(out["load_margin_n"], LoadMargin(contacts, {0, 0, -0.785}, 0.025, 4.0), 1e-12);
  EXPECT_EQ(out["load_margin_unbounded"], false);
}

TEST(EvaluateJson, LeavesTheLoadMarginOutWithoutAWeight) {
  const json out = json::parse(EvaluateJson(File(Tetrahedron(0.025, 0.5)).dump()));
  EXPECT_FALSE(out.contains("load_margin_n"));
  for (const MeasureInfo& info : kMeasureTable) EXPECT_TRUE(out.contains(info.name)) << info.name;
  EXPECT_EQ(out.size(), kNumMeasures + 1);  // and force_closure
}

TEST(EvaluateJson, SaysThatAnUnboundedMarginIsUnbounded) {
  json file = File(Tetrahedron(0.025, 0.5));
  file["weight_n"] = {0, 0, -0.785};
  const json out = json::parse(EvaluateJson(file.dump()));
  EXPECT_TRUE(out["load_margin_n"].is_null());
  EXPECT_EQ(out["load_margin_unbounded"], true);
}

TEST(EvaluateJson, OfASingleContactIsZero) {
  json file = File(Ring(1, 0.025, 0.8));
  file["weight_n"] = {0, 0, -0.785};
  const json out = json::parse(EvaluateJson(file.dump()));
  for (const char* name :
       {"epsilon", "volume", "min_singular_value", "sqrt_det", "isotropy", "load_margin_n"})
    EXPECT_EQ(out[name], 0.0) << name;
  EXPECT_EQ(out["force_closure"], false);
}

TEST(EvaluateJson, NormalisesNormalsThatAreNearlyUnit) {
  json file = File(Tetrahedron(0.025, 0.5));
  const json exact = json::parse(EvaluateJson(file.dump()));
  for (auto& contact : file["contacts"])
    for (auto& x : contact["normal"])
      x = std::round(x.get<double>() * 1e4) / 1e4;  // as people write them
  const json rounded = json::parse(EvaluateJson(file.dump()));
  EXPECT_NEAR(rounded["epsilon"], exact["epsilon"], 1e-12);  // all components round alike
}

TEST(EvaluateJson, TakesEightEdgesWhenNoneAreGiven) {
  json file = File(Tetrahedron(0.025, 0.5));
  const std::string eight = EvaluateJson(file.dump());
  file.erase("cone_edges");
  EXPECT_EQ(EvaluateJson(file.dump()), eight);
}

struct Bad {
  const char* pointer;  // what is replaced in a good file ...
  const char* value;    // ... by this; "" removes it
  const char* message;  // a part of the message
};

TEST(EvaluateJson, NamesFieldAndValueOfBadFiles) {
  const Bad table[] = {
      {"/contacts", "[]", "contacts: none"},
      {"/contacts", "3", "contacts: 3; allowed: an array"},
      {"/contacts", "", "contacts: missing"},
      {"/contacts/1", "7", "contacts[1]: 7; allowed: an object"},
      {"/contacts/1/mu", "", "contacts[1].mu: missing"},
      {"/contacts/1/mu", "-0.5", "contacts[1].mu: -0.5; allowed: 0 ... 10"},
      {"/contacts/1/mu", "11", "contacts[1].mu: 11; allowed"},
      {"/contacts/1/mu", "\"high\"", "contacts[1].mu: \"high\"; allowed: a number"},
      {"/contacts/1/mu", "true", "contacts[1].mu: true; allowed: a number"},
      {"/contacts/1/friction", "1", "contacts[1].friction: unknown name; nearest: "},
      {"/contacts/1/position", "[0,0,0]",
       "contacts[1].position: unknown name; nearest: position_m"},
      {"/contacts/1/normal", "[0,0]", "contacts[1].normal: [0,0]; allowed: an array of 3 numbers"},
      {"/contacts/1/normal", "[0,0,0]", "contacts[1].normal: length 0; allowed: a unit vector"},
      {"/contacts/1/normal", "[0,0.7,0.7]", "contacts[1].normal: length 0.989949494"},
      {"/contacts/1/normal", "[0,0,2]", "contacts[1].normal[2]: 2"},
      {"/contacts/1/normal", "[0,null,1]", "contacts[1].normal[1]: null"},
      {"/contacts/1/position_m", "[0,25,0]", "contacts[1].position_m[1]: 25; allowed: -10 ... 10"},
      {"/torque_scale_m", "", "torque_scale_m: missing"},
      {"/torque_scale_m", "0", "torque_scale_m: 0; allowed"},
      {"/torque_scale_m", "-1", "torque_scale_m: -1; allowed"},
      {"/torque_scal_m", "1", "torque_scal_m: unknown name; nearest: torque_scale_m"},
      {"/cone_edges", "2", "cone_edges: 2; allowed: 3 ... 1024"},
      {"/cone_edges", "1025", "cone_edges: 1025; allowed"},
      {"/normals", "\"up\"", "normals: \"up\"; allowed: \"inward\", \"outward\""},
      {"/contacts/1/torsional_mu", "-1", "contacts[1].torsional_mu: -1; allowed: 0 ... 10"},
      {"/cone_edges", "8.5", "cone_edges: 8.5; allowed: an integer"},
      {"/cone_edges", "\"8\"", "cone_edges: \"8\"; allowed: an integer"},
      {"/weight_n", "-0.785", "weight_n: -0.785; allowed: an array of 3 numbers"},
      {"/weight_n", "[0,0,1e300]", "weight_n[2]: 1e+300; allowed"},
      {"/max_force_n", "0", "max_force_n: 0; allowed: above 0"},
  };
  for (const Bad& bad : table) {
    json file = File(Tetrahedron(0.025, 0.5));
    const json::json_pointer pointer(bad.pointer);
    if (*bad.value) {
      file[pointer] = json::parse(bad.value);
    } else {
      file[pointer.parent_pointer()].erase(pointer.back());
    }
    try {
      EvaluateJson(file.dump());
      ADD_FAILURE() << "accepted " << bad.pointer << " = " << bad.value;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(bad.message), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

/// What EvaluateJson refuses this text with.
std::string Refusal(const std::string& text) {
  try {
    EvaluateJson(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "not refused";
}

TEST(EvaluateJson, NamesEverythingThatIsWrongAtOnce) {
  json file = File(Tetrahedron(0.025, 0.5));
  file["contacts"][0]["mu"] = -1;
  file["contacts"][1]["normal"] = {0, 0, 2};
  file["contacts"][1].erase("mu");
  file["contacts"][2]["position_m"] = {0, nullptr, "x"};
  file["contacts"][2]["torsional_mu"] = true;
  file["contacts"][3] = 7;
  file["cone_edge"] = 8;
  file["weight_n"] = 1;
  file["max_force_n"] = -2;
  file["normals"] = "up";
  EXPECT_EQ(Refusal(file.dump()), R"(11 errors:
  cone_edge: unknown name; nearest: cone_edges
  normals: "up"; allowed: "inward", "outward"
  contacts[1].mu: missing
  contacts[2].position_m[1]: null; allowed: a number
  contacts[2].position_m[2]: "x"; allowed: a number
  contacts[2].torsional_mu: true; allowed: a number
  contacts[3]: 7; allowed: an object
  weight_n: 1; allowed: an array of 3 numbers
  contacts[0].mu: -1; allowed: 0 ... 10
  contacts[1].normal[2]: 2; allowed: -1.001 ... 1.001
  max_force_n: -2; allowed: above 0)");
}

TEST(EvaluateJson, NamesEverythingThatIsWrongWithContactsOfTheDaemon) {
  EXPECT_EQ(Refusal(R"({"fingers": {"ring": {"in_contact": true, "role": "hold", "normal_W": 3},
                                    "thumb": {"role": "hold"}},
                        "object": {"p_WO_m": [0, 0]}, "friction": "high", "cone_edges": 2})"),
            R"(6 errors:
  object.p_WO_m: [0,0]; allowed: an array of 3 numbers
  friction: "high"; allowed: a number
  fingers.ring.p_WC_m: missing
  fingers.ring.normal_W: 3; allowed: an array of 3 numbers
  fingers.thumb.in_contact: missing
  cone_edges: 2; allowed: 3 ... 1024)");
}

TEST(EvaluateJson, CallsTheNumbersOfTheDaemonByTheirNamesThere) {
  const char* const finger = R"({"in_contact": true, "role": "hold", "p_WC_m": [0, 0, 1],
                                 "normal_W": [0, 0, -1]})";
  json file = {{"object", {{"p_WO_m", {0, 0, 0}}}}, {"friction", -1}};
  for (const char* name : {"index", "ring", "thumb"}) file["fingers"][name] = json::parse(finger);
  EXPECT_EQ(Refusal(file.dump()), "friction: -1; allowed: 0 ... 10");
  file["fingers"]["ring"]["normal_W"] = {0, 0, 2};
  file["fingers"]["thumb"]["p_WC_m"] = {0, 0, 11};
  EXPECT_EQ(Refusal(file.dump()), R"(3 errors:
  friction: -1; allowed: 0 ... 10
  fingers.ring.normal_W[2]: 2; allowed: -1.001 ... 1.001
  fingers.thumb.p_WC_m less object.p_WO_m[2]: 11; allowed: -10 ... 10)");
  file["fingers"]["ring"] = 7;
  EXPECT_NE(Refusal(file.dump()).find("  fingers.ring: 7; allowed: an object"), std::string::npos);
}

TEST(EvaluateJson, OfVeryManyMistakesNamesTheFirstAndCountsTheRest) {
  const json file = {{"contacts", std::vector<int>(300, 7)}, {"torque_scale_m", 1}};
  const std::string said = Refusal(file.dump());
  EXPECT_EQ(std::ranges::count(said, '\n'), 51);
  EXPECT_TRUE(said.ends_with("\n  contacts[49]: 7; allowed: an object\n  and 250 more")) << said;
}

TEST(EvaluateJson, RefusesTextThatIsNotStrictJson) {
  const std::pair<std::string, const char*> table[] = {
      {"", "line 1, column 1"},
      {"{", "line 1, column 2"},
      {"[]", "the file: []; allowed: an object"},
      {"{} {}", "line 1, column 4"},
      {R"({"torque_scale_m": NaN})", "line 1"},
      {R"({"torque_scale_m": 1e999})", "1e999"},
      {R"({"torque_scale_m": -1e999})", "1e999"},
      {R"({"torque_scale_m": 1, "torque_scale_m": 1})", "torque_scale_m: given twice"},
      {R"({"contacts": [{"mu": 1, "mu": 1}]})", "mu: given twice"},
      {std::string(33, '[') + std::string(33, ']'), "nested deeper than 32 levels"},
      {std::string(1'000'000, '['), "nested deeper than 32 levels"},
      {"{\"a\xff\": 1}", "UTF-8"},
      {"// none\n{}", "line 1"},
  };
  for (const auto& [text, message] : table) {
    try {
      EvaluateJson(text);
      ADD_FAILURE() << "accepted " << text.substr(0, 60);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
}

TEST(Evaluate, RefusesNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EvaluateInput good;
  good.contacts = Tetrahedron(0.025, 0.5);
  good.torque_scale = 0.025;
  good.weight = Vector3d(0, 0, -1);
  EXPECT_NO_THROW(Evaluate(good));
  for (int field = 0; field < 6; ++field) {
    EvaluateInput bad = good;
    if (field == 0) bad.contacts[1].position.x() = nan;
    if (field == 1) bad.contacts[1].inward_normal.y() = nan;
    if (field == 2) bad.contacts[1].mu = nan;
    if (field == 3) bad.torque_scale = nan;
    if (field == 4) bad.weight->z() = nan;
    if (field == 5) bad.max_force = nan;
    EXPECT_THROW(Evaluate(bad), std::invalid_argument) << field;
  }
}

TEST(Evaluate, LeavesTheVolumeOutWhereTheHullIsTooLarge) {
  EvaluateInput input;
  input.contacts = Ring(51, 0.025, 0.5);
  input.torque_scale = 0.025;
  const EvaluateOutput out = Evaluate(input);
  EXPECT_FALSE(out.of(Measure::kVolume).has_value());
  EXPECT_NEAR(*out.of(Measure::kEpsilon), EpsilonSolver().Compute(input.contacts, 0.025, 8), 1e-12);
  input.contacts = Ring(9, 0.025, 0.5);
  input.cone_edges = 1024;
  EXPECT_THROW(Evaluate(input), std::invalid_argument);
}

TEST(EvaluateJson, TakesTheContactsOfTheDaemonAsTheyAre) {
  const Contacts contacts = Tetrahedron(0.025, 0.5);
  const Vector3d centre(0.01, -0.06, 0.11);
  json live = {{"tick", 7},
               {"object", {{"p_WO_m", {centre.x(), centre.y(), centre.z()}}}},
               {"normals", "outward"},
               {"friction", 0.5},
               {"weight_n", {0, 0, -0.785}},
               {"max_force_n", 4},
               {"fingers", json::object()}};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vector3d p = contacts[i].position + centre, n = -contacts[i].inward_normal;
    live["fingers"][std::string(1, static_cast<char>('a' + i))] = {
        {"role", "hold"},
        {"in_contact", true},
        {"p_WC_m", {p.x(), p.y(), p.z()}},
        {"normal_W", {n.x(), n.y(), n.z()}},
        {"force_n", 1}};
  }
  live["fingers"]["free"] = {
      {"role", "free"}, {"in_contact", true}, {"p_WC_m", {0, 0, 0}}, {"normal_W", {0, 0, 1}}};
  live["fingers"]["off"] = {{"role", "hold"}, {"in_contact", false}, {"p_WC_m", nullptr}};
  json file = File(contacts);
  file["weight_n"] = {0, 0, -0.785};
  file["max_force_n"] = 4;
  const json from_live = json::parse(EvaluateJson(live.dump()));
  const json from_file = json::parse(EvaluateJson(file.dump()));
  for (const auto& [name, value] : from_file.items())
    if (value.is_number()) EXPECT_NEAR(from_live[name], value, 1e-9) << name;  // sums round
  EXPECT_FALSE(from_live.contains("warnings"));
}

TEST(EvaluateJson, AMarginOfNothingIsZeroAndNotMinusZero) {
  json file = File({Tetrahedron(0.025, 0.5)[0]});
  file["weight_n"] = {0, 0, -0.785};
  const std::string out = EvaluateJson(file.dump());
  EXPECT_NE(out.find("\"load_margin_n\":0.0"), std::string::npos) << out;
}

TEST(EvaluateJson, WarnsOfNormalsThatAllPointAway) {
  json file = File(Tetrahedron(0.025, 0.5));
  for (auto& contact : file["contacts"])
    for (auto& x : contact["normal"]) x = -x.get<double>();
  EXPECT_EQ(json::parse(EvaluateJson(file.dump()))["warnings"].size(), 1u);
  file["normals"] = "outward";
  const json turned = json::parse(EvaluateJson(file.dump()));
  EXPECT_FALSE(turned.contains("warnings"));
  EXPECT_EQ(turned["epsilon"],
            json::parse(EvaluateJson(File(Tetrahedron(0.025, 0.5)).dump()))["epsilon"]);
}

TEST(Evaluate, SoftFingersHoldWithTwoContacts) {
  EvaluateInput input;
  for (const double side : {1.0, -1.0})
    input.contacts.push_back({Vector3d(side * 0.025, 0, 0), Vector3d(-side, 0, 0), 0.5});
  input.torque_scale = 0.025;
  input.weight = Vector3d(0, 0, -0.785);
  input.max_force = 4;
  const EvaluateOutput hard = Evaluate(input);
  EXPECT_EQ(*hard.of(Measure::kEpsilon), 0);  // nothing resists a turn about the line of the two
  EXPECT_EQ(*hard.load_margin, 0);
  for (GraspContact& contact : input.contacts) contact.torsion = 0.005;
  const EvaluateOutput soft = Evaluate(input);
  EXPECT_GT(*soft.of(Measure::kEpsilon), 0);
  // About x: both contacts at 4 N with 5 mm give 0.04 N m, over 0.025 m 1.6 N, less what the
  // ellipsoid gives to the weight: 4 N sqrt(1 - (0.3925 / 2)²) each.
  EXPECT_LT(*soft.load_margin, 1.6);
  EXPECT_GT(*soft.load_margin, 0.5);
}

}  // namespace
}  // namespace regrasp
