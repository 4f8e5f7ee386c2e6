#include "cli/grammar/units.h"

#include <gtest/gtest.h>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

double Read(const std::string& text, std::string_view unit) {
  return ParseQuantity(text, "--x", unit);
}

TEST(Units, WordsAsAPersonTypesThemMeanTheUnit) {
  EXPECT_DOUBLE_EQ(Read("0.5turns", "deg"), 180);
  EXPECT_DOUBLE_EQ(Read("1 turn", "deg"), 360);
  EXPECT_DOUBLE_EQ(Read("90 degrees", "deg"), 90);
  EXPECT_DOUBLE_EQ(Read("1degree", "deg"), 1);
  EXPECT_DOUBLE_EQ(Read("45°", "deg"), 45);
  EXPECT_DOUBLE_EQ(Read("2radians", "rad"), 2);
  EXPECT_DOUBLE_EQ(Read("1.5seconds", "s"), 1.5);
  EXPECT_DOUBLE_EQ(Read("2 minutes", "s"), 120);
  EXPECT_DOUBLE_EQ(Read("5millimetres", "mm"), 5);
  EXPECT_DOUBLE_EQ(Read("1 meter", "mm"), 1000);
  EXPECT_DOUBLE_EQ(Read("2newtons", "N"), 2);
  EXPECT_DOUBLE_EQ(Read("50 grams", "kg"), 0.05);
  EXPECT_DOUBLE_EQ(Read("3hertz", "Hz"), 3);
  EXPECT_DOUBLE_EQ(Read("50 micrometers", "mm"), 0.05);
  // Micro has two letters in Unicode.
  EXPECT_DOUBLE_EQ(Read("50\u00b5m", "mm"), 0.05);
  EXPECT_DOUBLE_EQ(Read("50\u03bcm", "mm"), 0.05);
}

TEST(Units, WordsMakeQuotientsToo) {
  EXPECT_DOUBLE_EQ(Read("30degrees/second", "deg/s"), 30);
  EXPECT_DOUBLE_EQ(Read("5 millimeters/sec", "mm/s"), 5);
  EXPECT_DOUBLE_EQ(Read("30deg/s", "deg/s"), 30);
}

TEST(Units, OtherKindsAndUnknownWordsAreRefused) {
  for (const char* text : {"1turns", "1seconds", "1 furlongs", "1millimetress", "1degrees/second",
                           "1mm/", "1/mm", "1mm/s/s"})
    EXPECT_THROW(Read(text, "mm"), CliError) << text;
  try {
    Read("5 seconds", "deg");
    FAIL();
  } catch (const CliError& error) {
    EXPECT_STREQ(error.what(),
                 "--x: '5 seconds' has the unit 'seconds'; allowed are deg, rad, turn (without one "
                 "it is deg)");
  }
}

}  // namespace
}  // namespace regrasp::cli
