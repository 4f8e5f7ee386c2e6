// The table of parameters and how its values are written.

#include "core/session/parameter_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/session/session.h"

namespace regrasp {
namespace {

const ParameterInfo& Row(const char* name) {
  const int index = FindParameter(name);
  EXPECT_GE(index, 0) << name;
  return ParameterTable()[static_cast<std::size_t>(index)];
}

/// What reading complains about; "" when it does not.
std::string Complaint(const char* name, const GivenValue& given) {
  try {
    ReadParameterValue(Row(name), given);
    return "";
  } catch (const ParameterError& e) {
    return std::string(e.what()) + "|" + e.hint;
  }
}

TEST(ParameterTable, EveryRowIsComplete) {
  const Parameters defaults;
  std::string_view before;
  for (const ParameterInfo& info : ParameterTable()) {
    EXPECT_LT(before, info.name) << "sorted, no name twice";
    before = info.name;
    EXPECT_TRUE(info.meaning.ends_with('.')) << info.name;
    EXPECT_FALSE(info.source.empty()) << info.name;
    EXPECT_LT(info.min, info.max) << info.name;
    EXPECT_EQ(info.type == ParameterType::kWord, !info.words.empty()) << info.name;
    const Vector3d value = info.get(defaults);
    for (int k = 0; k < info.size(); ++k) {
      EXPECT_GE(value[k], info.min) << info.name;
      EXPECT_LE(value[k], info.max) << info.name;
    }
    // set() reaches the member that get() reads, and no other.
    Parameters changed;
    const Vector3d other = info.size() == 3
                               ? Vector3d(info.min, info.max, 0)
                               : Vector3d(value.x() == info.min ? info.max : info.min, 0, 0);
    info.set(&changed, other);
    EXPECT_EQ(info.get(changed), other) << info.name;
    for (const ParameterInfo& another : ParameterTable()) {
      if (another.name == info.name) continue;
      EXPECT_EQ(another.get(changed), another.get(defaults)) << info.name << ' ' << another.name;
    }
  }
}

TEST(ParameterValue, WhatIsWrittenIsReadBack) {
  const Parameters defaults;
  for (const ParameterInfo& info : ParameterTable()) {
    const Vector3d value = info.get(defaults);
    const std::string text = ParameterText(info, value);
    GivenValue given = text;
    if (info.type == ParameterType::kReal || info.type == ParameterType::kInteger)
      given = std::stod(text);
    if (info.type == ParameterType::kVector)
      given = std::vector<double>{value.x(), value.y(), value.z()};
    EXPECT_EQ(ReadParameterValue(info, given), value) << info.name << " = " << text;
  }
}

TEST(ParameterValue, ReadsWordsBooleansAndTheirFormerNumbers) {
  EXPECT_EQ(ReadParameterValue(Row("gait.mode"), "exploring").x(), 0);
  EXPECT_EQ(ReadParameterValue(Row("gait.mode"), "returning").x(), 1);
  EXPECT_EQ(ReadParameterValue(Row("gait.mode"), 1.0).x(), 1);
  EXPECT_EQ(ReadParameterValue(Row("gait.hop"), false).x(), 0);
  EXPECT_EQ(ReadParameterValue(Row("gait.hop"), "true").x(), 1);
  EXPECT_EQ(ReadParameterValue(Row("gait.hop"), 0.0).x(), 0);
  Parameters parameters;
  Row("gait.mode").set(&parameters, ReadParameterValue(Row("gait.mode"), "exploring"));
  EXPECT_EQ(parameters.gait.mode, GaitMode::kExploring);
}

TEST(ParameterValue, SaysWhatIsWrongAndWhatIsAllowed) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Complaint("object.friction", "0,5"),
            "object.friction is one number, with a point, not '0,5'|allowed: 0.001 ... 1");
  EXPECT_EQ(
      Complaint("object.friction", std::string("0.5")),
      "object.friction is a number, and '0.5' is text: leave out the quotes|allowed: 0.001 ... 1");
  EXPECT_EQ(Complaint("object.friction", std::vector<double>{1, 1, 1}),
            "object.friction is one number, with a point, not [1, 1, 1]|allowed: 0.001 ... 1");
  EXPECT_EQ(Complaint("object.friction", 7.0),
            "object.friction = 7 is out of range|allowed: 0.001 ... 1");
  EXPECT_NE(Complaint("object.friction", kNan), "");
  EXPECT_NE(Complaint("object.friction", true), "");
  EXPECT_EQ(Complaint("exploration.max_cycles", 1.5),
            "exploration.max_cycles = 1.5: expected an integer, 1 ... 1000000 ticks|allowed: an "
            "integer, 1 ... 1000000 ticks");
  EXPECT_EQ(Complaint("gait.mode", "explorin"),
            "gait.mode = 'explorin': expected exploring or returning|did you mean 'exploring'?");
  EXPECT_NE(Complaint("gait.mode", 2.0), "");
  EXPECT_NE(Complaint("gait.mode", 0.5), "");
  EXPECT_NE(Complaint("gait.mode", -1.0), "");
  EXPECT_NE(Complaint("gait.mode", kNan), "");
  EXPECT_EQ(Complaint("gait.hop", 2.0),
            "gait.hop = 2: expected true or false|allowed: true or false");
  EXPECT_EQ(Complaint("gravity", std::vector<double>{1, 2}),
            "gravity is 3 numbers, not [1, 2]|allowed: 3 numbers, each -50 ... 50 m/s2");
  EXPECT_NE(Complaint("gravity", 9.81), "");
  EXPECT_NE(Complaint("gravity", std::vector<double>{0, 0, 51}), "");
  // A long value is cut between two characters.
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "ä";
  EXPECT_LT(Complaint("gait.mode", "x" + umlauts).size(), 200u);
}

TEST(CheckMeasure, RefusesToMaximiseWhatIsTooSlowForATick) {
  using Kind = Verdict::Kind;
  const auto verdict = [](Measure measure, JobMethod method, Criterion criterion, GaitMode mode) {
    Parameters parameters;
    parameters.control.stability_measure = measure;
    parameters.gait.mode = mode;
    return CheckMeasure(parameters, method, criterion).kind;
  };
  constexpr auto kReturning = GaitMode::kReturning, kExploring = GaitMode::kExploring;
  for (std::size_t i = 0; i < kNumFrameMeasures; ++i) {
    const auto measure = static_cast<Measure>(i);
    const Kind slow =
        kMeasureTable[i].cost == MeasureCost::kTick ? Kind::kAllowed : Kind::kBadState;
    for (const CriterionInfo& criterion : kCriterionTable)
      EXPECT_EQ(verdict(measure, JobMethod::kExplore, criterion.id, kReturning),
                criterion.takes_stability ? slow : Kind::kAllowed)
          << kMeasureTable[i].name << ' ' << criterion.name;
    EXPECT_EQ(verdict(measure, JobMethod::kRotate, Criterion::kManipulability, kExploring), slow);
    EXPECT_EQ(verdict(measure, JobMethod::kRotate, Criterion::kManipulability, kReturning),
              Kind::kAllowed);
    EXPECT_EQ(verdict(measure, JobMethod::kMove, Criterion::kStability, kExploring),
              Kind::kAllowed);
  }
  // One measure at least is too slow, or the loop has shown nothing.
  EXPECT_EQ(verdict(Measure::kEpsilon, JobMethod::kExplore, Criterion::kStability, kReturning),
            Kind::kBadState);
}

}  // namespace
}  // namespace regrasp
