// Objects as files: done by regrasp-object, without a daemon.

#include "cli/commands/object.h"

#include <fmt/format.h>

#include "cli/client/context.h"
#include "cli/client/program.h"

namespace regrasp::cli {
namespace {

ExitCode Show(Context& context, const Invocation& invocation) {
  context.RefuseCsv(invocation);
  std::vector<std::string> arguments = {FindHelper("regrasp-object"), "show",
                                        invocation.Text("file")};
  for (const char* flag : {"inertia-from-shape", "force"})
    if (invocation.Has(flag)) arguments.push_back(std::string("--") + flag);
  if (invocation.Has("output")) {
    arguments.push_back("--output");
    arguments.push_back(invocation.Text("output"));
  }
  if (context.out().format() == Format::kJson) arguments.push_back("--json");
  if (context.options().quiet) arguments.push_back("--quiet");
  return RunHelper(arguments, invocation.Text("output"));
}

}  // namespace

std::vector<CommandSpec> ObjectCommands() {
  return {{"object show",
           "Models",
           "what an object's file says: size, mass, inertia, pieces, and why it would be refused",
           nullptr,
           {{.key = "file",
             .flags = "",
             .metavar = "FILE",
             .help = "a URDF, or the name of an object",
             .required = true},
            {.key = "output",
             .flags = "-o,--output",
             .metavar = "PICTURE",
             .help = "draw it there: .png, .jpg, .pdf, .svg"},
            {.key = "inertia-from-shape",
             .flags = "--inertia-from-shape",
             .metavar = "",
             .kind = ArgKind::kFlag,
             .help = "centre and inertia of a homogeneous body of this shape and mass"},
            {.key = "force",
             .flags = "--force",
             .metavar = "",
             .kind = ArgKind::kFlag,
             .help = "take a moment, centre of mass or density that cannot be"}},
           Show}};
}

}  // namespace regrasp::cli
