#include "core/common/fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace regrasp {
namespace {

namespace fs = std::filesystem;

std::set<std::string> Matches(const std::string& text, const std::regex& what) {
  std::set<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), what), end; it != end; ++it)
    found.insert((*it)[1]);
  return found;
}

/// The text of every `Fields` member of a header.
std::string FieldsOf(const std::string& text) {
  std::string fields;
  for (std::size_t at = 0; (at = text.find("void Fields(V& v) {", at)) != std::string::npos; ++at) {
    const std::size_t line = text.rfind('\n', at) + 1;
    const std::string close = "\n" + text.substr(line, at - line) + "}\n";
    fields += text.substr(at, text.find(close, at) - at);
  }
  return fields;
}

// A member that nobody names would be missing from the state hash and from saved states.
TEST(Fields, NameEveryMemberOfTheirHeader) {
  // What is set anew before it is read, is fixed, or follows from the others.
  const std::map<std::string, std::set<std::string>> unnamed = {
      {"core/control/contact_force_qp.h", {"forces_"}},
      {"core/control/estimate.h", {"dt_", "taxels_"}},
      {"core/session/activity/grasp.h", {"refusal_"}},
      {"core/session/judge.h", {"hand_"}},
      {"core/shape/felt_surface.h", {"parameters_"}},
      {"core/control/hybrid_controller.h", {"dt_", "problem_", "torque_"}},
      {"core/sensing/sensors.h", {"dt_", "kinematics_", "tips_"}},
      {"core/session/quality_monitor.h", {"epsilon_"}},
      {"core/world/world.h", {"impl_"}},
  };
  const std::regex comment("//[^\n]*"), member("([a-z]\\w*_)\\s*(?:=[^;,]*|\\{[^;]*\\})?[;,]"),
      word("\\b([a-z]\\w*_)\\b");
  const fs::path root = REGRASP_SOURCE_DIR;
  int classes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root / "core")) {
    const std::string name = fs::relative(entry.path(), root).string();
    if (entry.path().extension() != ".h" || name == "core/common/fields.h") continue;
    std::ifstream in(entry.path());
    const std::string text =
        std::regex_replace(std::string(std::istreambuf_iterator<char>(in), {}), comment, "");
    const std::string fields = FieldsOf(text);
    if (fields.empty()) continue;
    ++classes;
    std::set<std::string> missing = Matches(text, member);
    for (const std::string& named : Matches(fields, word)) missing.erase(named);
    const auto allowed = unnamed.find(name);
    EXPECT_EQ(missing, allowed == unnamed.end() ? std::set<std::string>() : allowed->second)
        << name;
  }
  EXPECT_GT(classes, 30);
}

enum class Kind : std::uint8_t { kOne, kTwo };
struct Inner {
  int finger = -1;
  Kind kind = Kind::kTwo;
  template <typename V>
  void Fields(V& v) {
    v("finger", finger, v.Finger());
    v("kind", kind, Kind::kTwo);
  }
};
struct Outer {
  double length_m = 0.5;
  FixedVector<Inner, 3> inner;
  template <typename V>
  void Fields(V& v) {
    v("length_m", length_m);
    v("inner", inner);
  }
};

/// What is said of a saved Outer after `change`, or "" when it is loaded.
std::string Refusal(void (*change)(Outer*), std::size_t cut = 0) {
  Outer outer;
  outer.inner.push_back({});
  change(&outer);
  std::string bytes;
  FieldSaver saver(&bytes);
  outer.Fields(saver);
  bytes.resize(bytes.size() - cut);
  FieldLoader loader(bytes, 5);
  Outer loaded;
  try {
    loaded.Fields(loader);
    loader.Finish();
  } catch (const StateError& error) {
    return error.what();
  }
  return "";
}

TEST(Fields, AreLoadedWithinTheirRangesAndRefusedByName) {
  EXPECT_EQ(Refusal([](Outer*) {}), "");
  EXPECT_EQ(Refusal([](Outer* o) { o->inner[0].finger = 5; }),
            "saved state: inner.finger is 5, allowed: -1 to 4");
  EXPECT_EQ(Refusal([](Outer* o) { o->inner[0].kind = static_cast<Kind>(7); }),
            "saved state: inner.kind is 7, allowed: 0 to 1");
  EXPECT_EQ(Refusal([](Outer* o) { o->length_m = 1e300; }),
            "saved state: length_m is 1e+300, allowed: -1e+09 to 1e+09");
  EXPECT_EQ(Refusal([](Outer* o) { o->length_m = std::nan(""); }),
            "saved state: length_m is nan, allowed: -1e+09 to 1e+09");
  EXPECT_EQ(Refusal([](Outer*) {}, 1),
            "saved state: inner.kind is missing: the state ends too early");
}

}  // namespace
}  // namespace regrasp
