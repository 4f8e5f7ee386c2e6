// Hands as files: done by regrasp-hand, without a daemon.

#include "cli/commands/hand.h"

#include <fmt/format.h>

#include "cli/client/context.h"
#include "cli/client/program.h"
#include "cli/grammar/ranges.h"

namespace regrasp::cli {
namespace {

constexpr const char* kGroup = "Models";

ExitCode RunHand(Context& context, const Invocation& invocation) {
  context.RefuseCsv(invocation);
  const std::string verb = invocation.command->words.substr(std::string("hand ").size());
  std::vector<std::string> arguments = {FindHelper("regrasp-hand"), verb, invocation.Text("file")};
  for (const Arg& arg : invocation.command->args) {
    if (arg.key == "file" || !invocation.Has(arg.key)) continue;
    if (arg.kind != ArgKind::kFlag) {
      arguments.push_back("--" + arg.key);
      arguments.push_back(invocation.Text(arg.key));
    } else if (invocation.Text(arg.key) != "false") {
      arguments.push_back("--" + arg.key);
    }
  }
  if (context.out().format() == Format::kJson) arguments.push_back("--json");
  if (context.options().quiet) arguments.push_back("--quiet");
  return RunHelper(arguments, invocation.Text("output"));
}

std::vector<Arg> WithLoadFlags(std::vector<Arg> args) {
  for (const auto& [key, help] :
       {std::pair{"inertia-from-shape", "compute the inertias that are missing or cannot be"},
        std::pair{"fill-missing-meshes", "a capsule along the link where a mesh is not there"}}) {
    Arg flag = TextArg(key, std::string("--") + key, "", help);
    flag.kind = ArgKind::kFlag;
    args.push_back(std::move(flag));
  }
  return args;
}

}  // namespace

std::vector<CommandSpec> HandCommands() {
  Arg any = TextArg("file", "", "FILE", "a URDF, a scenario, or the name of a hand");
  Arg urdf = TextArg("file", "", "FILE", "the hand's URDF");
  Arg out = TextArg("output", "-o,--output", "NAME.toml", "the scenario; must not exist");
  any.required = urdf.required = out.required = true;
  const auto number = [](std::string key, std::string metavar, std::string help,
                         std::string default_text, double min, double max) {
    Arg arg =
        TextArg(key, "--" + key, std::move(metavar), std::move(help), std::move(default_text));
    arg.kind = ArgKind::kNumber;
    arg.min = min;
    arg.max = max;
    return arg;
  };
  Arg seed =
      number("seed", "N", "of the search: another gives another grasp", "1", 0, kMaxSafeInteger);
  seed.kind = ArgKind::kInteger;
  return {
      {"hand check", kGroup,
       "what a hand's file says: fingers, limits, fits, warnings, the stepper that suits it",
       nullptr,
       WithLoadFlags(
           {any, TextArg("output", "-o,--output", "FILE", "a picture of the hand, .png")}),
       RunHand},
      {"hand new", kGroup,
       "make a scenario for a hand from its URDF alone: fingers, palm, postures of a grasp",
       nullptr,
       WithLoadFlags(
           {urdf, out,
            TextArg("object", "--object", "NAME|FILE",
                    "what to grasp instead of a ball: it is turned until it fits"),
            number("object-size", "MM",
                   "diameter of the ball to grasp, or that stands for the object",
                   "50; with --object up to four that follow from it", kLeastBall_mm, kMostBall_mm),
            seed,
            number("tilt", "DEG", "0: palm up, 90: fingers straight down", "65", -kMostTilt_deg,
                   kMostTilt_deg)}),
       RunHand},
  };
}

}  // namespace regrasp::cli
