#include "cli/commands/shape.h"

#include <fmt/format.h>

#include <filesystem>
#include <numbers>

#include "cli/client/context.h"
#include "cli/commands/surface_file.h"
#include "core/files/lower_suffix.h"
#include "core/files/output_file.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

void PrintShape(Output& out, const Json& s) {
  out.Line(fmt::format("object       {}", Plain(At(s, "object"))));
  out.Line(fmt::format("touched      {} % of all directions ({} of {} cells)",
                       Fixed(At(s, "touched_fraction"), 1, 100), Plain(At(s, "touched_cells")),
                       Plain(At(s, "cells"))));
  out.Line(fmt::format("mean radius  {} mm", Fixed(At(s, "mean_radius_m"), 2, 1e3)));
  const Json& truth = At(s, "truth");
  if (truth.is_null()) return out.Line("error        nothing was felt long enough to judge it");
  out.Line(fmt::format("error        rms {} mm, bias {} mm, normals {}{} (median), by the truth",
                       Fixed(At(truth, "rms_error_m"), 2, 1e3),
                       Fixed(At(truth, "mean_error_m"), 2, 1e3),
                       Fixed(At(truth, "normal_error_rad"), 1, kDegrees), out.Degree()));
}

ExitCode Shape(Context& context, const Invocation& invocation) {
  namespace fs = std::filesystem;
  const std::string target = invocation.Text("output");
  const std::string suffix = LowerSuffix(target);
  if (invocation.Has("output") && suffix != ".ply" && suffix != ".stl")
    throw CliError(kUsage, fmt::format("-o {}: the suffix decides: .ply or .stl", target),
                   "regrasp shape -o felt.ply");
  Invocation request = invocation;
  if (invocation.Has("output")) request.params["mesh"] = true;
  if (invocation.Has("output")) {
    try {
      CheckWritable(target, Draft::Existing::kReplace);
    } catch (const WriteError& e) {
      throw CliError(kIo, e.what(), "regrasp shape -o OTHER_FILE");
    }
  }
  Json answer = context.Call(request);
  if (invocation.Has("output")) {
    const Json& mesh = At(answer, "mesh");
    try {
      WriteWhole(target, suffix == ".ply" ? PlyText(mesh) : StlText(mesh),
                 Draft::Existing::kReplace);
    } catch (const std::exception& e) {
      throw CliError(kIo, fmt::format("cannot write {}: {}", target, e.what()),
                     "regrasp shape -o OTHER_FILE");
    }
    answer.erase("mesh");
    answer["path"] = fs::absolute(target).string();
  }
  context.Print(answer, [&] {
    PrintShape(context.out(), answer);
    if (invocation.Has("output")) context.out().Line(fmt::format("written      {}", target));
  });
  return kOk;
}

}  // namespace

CommandSpec ShapeCommand() {
  return MethodCommand(
      "shape", "Inspect", Shape,
      {.hidden = {"mesh"},
       .extra = {{.key = "output",
                  .flags = "-o,--output",
                  .metavar = "FILE",
                  .help = "write the surface as a closed mesh, in metres, one point in "
                          "each direction from the object's centre, so without holes; the suffix "
                          "decides: .ply (with what is unknown, and the error), .stl",
                  .default_text = "print what is known of it"}}});
}

}  // namespace regrasp::cli
