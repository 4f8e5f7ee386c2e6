// Holding, one motion without a regrasp, and whether the same run gives the same bits: straight on
// the session. Turns and explorations are measured by `regrasp experiment`.
//   claims hold      [--seeds N] [--first S] [--seconds T]   six gravity directions
//   claims objects   [--seeds N] [--first S] [--seconds T]   spheres of 45, 50, 60 mm and the egg,
//                    or those of --object A,B,... (names or .urdf files) [--inertia-from-shape]
//   claims move      [--seeds N] [--first S] [--angle DEG] [--offset MM] [--axis X,Y,Z | all]
//                    one motion about and along the axis, without a regrasp; --reach: for each
//                    start, the angle that geometry allows a ball on which all fingertips roll
//                    (bench/rolling_reach.h), beside what was reached
//   claims repeat    [--seconds T]                            state hash of the same run, twice
// Common: --hand NAME|FILE --noise PRESET --object NAME --tilt DEG (of the palm) --set NAME=VALUE
// (repeatable)
// --exact --rows (a line per trial). Trials run in two processes (--jobs N); each is reproducible
// alone from its seed.

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "bench/claims/claims.h"

namespace regrasp::claims {
namespace {

Options ReadOptions(int argc, char** argv) {
  Options o;
  if (argc > 1) o.what = argv[1];
  for (int i = 2; i < argc; ++i) {
    const std::string a = argv[i];
    auto next = [&]() -> std::string {
      if (++i >= argc) {
        std::fprintf(stderr, "claims: %s needs a value\n", a.c_str());
        std::exit(2);
      }
      return argv[i];
    };
    if (a == "--seeds")
      o.seeds = std::stoi(next());
    else if (a == "--first")
      o.first = std::stoull(next());
    else if (a == "--seconds")
      o.seconds = std::stod(next());
    else if (a == "--hand")
      o.hand = next();
    else if (a == "--noise")
      o.noise = next();
    else if (a == "--object")
      o.object = next();
    else if (a == "--angle")
      o.angle = std::stod(next());
    else if (a == "--offset")
      o.offset_mm = std::stod(next());
    else if (a == "--tilt")
      o.tilt = std::stod(next());
    else if (a == "--axis")
      o.axis = next();
    else if (a == "--jobs")
      o.jobs = std::stoi(next());
    else if (a == "--exact")
      o.exact = true;
    else if (a == "--rows")
      o.rows = true;
    else if (a == "--reach")
      o.reach = true;
    else if (a == "--inertia-from-shape")
      o.inertia_from_shape = true;
    else if (a == "--set")
      o.set.push_back(ReadSetting(next()));
    else {
      std::fprintf(stderr, "claims: unknown option %s\n", a.c_str());
      std::exit(2);
    }
  }
  return o;
}

int Main(int argc, char** argv) {
  const Options o = ReadOptions(argc, argv);
  if (o.what != "objects")
    MakeConfig(o, o.first, o.object);  // throws here, before any trial, what is wrong with them
  if (o.what == "hold") return Hold(o);
  if (o.what == "objects") return Objects(o);
  if (o.what == "move") return Move(o);
  if (o.what == "repeat") return Repeat(o);
  std::fprintf(
      stderr,
      "usage: claims hold|objects|move|repeat [options]; see the head of bench/claims/main.cc\n");
  return 2;
}

}  // namespace
}  // namespace regrasp::claims

int main(int argc, char** argv) {
  try {
    return regrasp::claims::Main(argc, argv);
  } catch (const std::invalid_argument&) {
    std::fprintf(stderr, "claims: the value of an option is not a number\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "claims: %s\n", error.what());
  }
  return 2;
}
