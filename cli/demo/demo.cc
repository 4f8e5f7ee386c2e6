#include "cli/demo/demo.h"

#include <fmt/format.h>

#include <filesystem>

#include "cli/demo/figures.h"
#include "cli/experiment/store.h"

namespace regrasp::cli {

namespace fs = std::filesystem;

ExitCode Demo(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const auto seed = static_cast<std::int64_t>(ParseNumber(invocation.Text("seed", "1"), "--seed"));
  const int repeats = static_cast<int>(ParseNumber(invocation.Text("repeats", "10"), "--repeats"));
  const fs::path output = fs::absolute(invocation.Text("output", "regrasp-demo"));
  std::error_code error;
  fs::create_directories(output, error);
  if (error)
    throw CliError(kIo, fmt::format("cannot make {}: {}", output.string(), error.message()),
                   "regrasp demo -o OTHER_DIR");

  std::vector<std::string> arguments = {"--output-dir", output};
  if (invocation.Has("models-dir")) {
    arguments.insert(arguments.end(),
                     {"--models-dir", fs::absolute(invocation.Text("models-dir")).string()});
  }
  SteppedDaemon daemon(arguments);
  Figures figures(context, &daemon, output, seed);
  figures.Grasp();
  figures.Explorations(repeats);
  figures.Rotations();

  const bool good = figures.held();
  Json answer = {{"ok", good},
                 {"output_dir", output.string()},
                 {"seed", seed},
                 {"claims", Json::array()},
                 {"measured", figures.measured()}};
  for (const auto& claim : figures.claims()) {
    answer["claims"].push_back({{"claim", claim.claim},
                                {"measured", claim.measured},
                                {"verdict", claim.shown ? "shown" : "missed"}});
  }
  WriteFile(output / "summary.json", answer.dump(1) + "\n");
  context.Print(answer, [&] {
    Output& out = context.out();
    Table table({"THE PAPER", "THIS RUN", ""});
    for (const auto& claim : figures.claims()) {
      table.Row({claim.claim, claim.measured,
                 claim.shown ? out.Paint(std::string(out.Tick()), Style::kGood)
                             : out.Paint("MISSED", Style::kWarn)});
    }
    out.Add(table.Text(out));
    out.Line();
    for (const auto& picture : figures.measured().at("pictures"))
      out.Line("picture  " + Plain(picture));
    out.Line("figures  " + (output / "summary.json").string());
  });
  return good ? kOk : kFailed;
}

}  // namespace regrasp::cli
