// Checkpoints.

#include <fmt/format.h>

#include "cli/client/context.h"
#include "cli/commands/jobs.h"
#include "cli/commands/run_files.h"

namespace regrasp::cli {
namespace {

constexpr const char* kGroup = "Results";

ExitCode Save(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    context.out().Line(fmt::format(
        "checkpoint {}: {} at {} s (tick {}), state hash {}{}", Plain(At(answer, "name")),
        Plain(At(answer, "state")), Fixed(At(answer, "time_s"), 3), Plain(At(answer, "tick")),
        Plain(At(answer, "state_hash")),
        At(answer, "replaced") == true ? "; replaces the one before" : ""));
  });
  return kOk;
}

ExitCode List(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  const auto& list = At(answer, "checkpoints");
  context.PrintRows(answer, std::vector<Json>(list.begin(), list.end()), [&] {
    if (list.empty())
      return context.out().Line("no checkpoint" + context.Next("regrasp checkpoint save NAME"));
    Table table(
        {"name", ">time [s]", "state", "object", ">seed", ">commands", "state hash", "build"});
    for (const Json& row : list)
      table.Row({Plain(At(row, "name")), Fixed(At(row, "time_s"), 3), Plain(At(row, "state")),
                 Plain(At(row, "object")), Plain(At(row, "seed")), Plain(At(row, "commands")),
                 Plain(At(row, "state_hash")), At(row, "same_build") == true ? "this" : "another"});
    context.out().Add(table.Text(context.out()));
  });
  return kOk;
}

}  // namespace

std::vector<CommandSpec> CheckpointCommands() {
  return {
      MethodCommand("checkpoint.save", kGroup, Save, {.positional = {"name"}}),
      MethodCommand("checkpoint.restore", kGroup, StartJob, {.positional = {"name"}}),
      MethodCommand("checkpoint.list", kGroup, List),
  };
}

}  // namespace regrasp::cli
