#include "cli/hand/scenario_file.h"

#include <fmt/format.h>

#include <stdexcept>

#include "cli/hand/hand_command.h"
#include "core/files/names.h"
#include "core/files/output_file.h"

namespace regrasp::hand {

namespace fs = std::filesystem;
namespace {

/// A path that a scenario can name.
std::string InToml(std::string path) {
  if (!IsUtf8(path))
    throw Failure(ExitCode::kFailed, path + ": is not UTF-8; a scenario cannot name it",
                  "rename the file or its directory");
  return path;
}

}  // namespace

void ScenarioFile::Check() const {
  if (path_.extension() != ".toml")
    throw Failure(ExitCode::kUsage,
                  fmt::format("-o {}: a scenario file must end in .toml", path_.string()),
                  "regrasp help hand new");
  if (const std::string fault = NameFault(path_.filename().string()); !fault.empty())
    throw Failure(ExitCode::kUsage,
                  fmt::format("-o {}: the name of a scenario {}", path_.string(), fault),
                  "another name for -o");
  std::error_code ignored;
  if (fs::exists(path_, ignored))
    throw Failure(ExitCode::kIo, fmt::format("{}: exists; nothing is overwritten", path_.string()),
                  "another name for -o, or remove the file");
  const fs::path directory = path_.parent_path().empty() ? "." : path_.parent_path();
  if (!fs::is_directory(directory, ignored))
    throw Failure(ExitCode::kIo, fmt::format("{}: no such directory", directory.string()),
                  "mkdir -p " + ShellWord(directory.string()));
  try {
    CheckWritable(path_.string(), Draft::Existing::kKeep);
  } catch (const WriteError& error) {
    throw Failure(ExitCode::kIo, error.what(), "another place for -o");
  }
}

std::string ScenarioFile::NameOfObject(const std::string& object) const {
  if (fs::path(object).extension() != ".urdf") return object;
  const std::string relative = WayTo(object);
  return InToml(relative.empty() ? fs::absolute(object).string() : relative);
}

std::string ScenarioFile::NameOfUrdf(const fs::path& urdf) const {
  const std::string relative = WayTo(urdf);
  if (relative == name() + ".urdf") return "";
  return InToml(relative.empty() ? fs::absolute(urdf).string() : relative);
}

std::string ScenarioFile::WayTo(const fs::path& file) const {
  std::error_code ignored;
  const fs::path directory =
      fs::absolute(path_.parent_path().empty() ? fs::path(".") : path_.parent_path(), ignored);
  return fs::relative(fs::absolute(file, ignored), directory.lexically_normal(), ignored).string();
}

void ScenarioFile::CheckBall() const {
  std::error_code ignored;
  const fs::path ball = path_.parent_path() / BallName();
  if (fs::exists(ball, ignored))
    throw Failure(ExitCode::kIo,
                  fmt::format("{}: exists; nothing is overwritten, and a ball of this size needs a "
                              "file of its own",
                              ball.string()),
                  "another name for -o, or remove the file");
}

void ScenarioFile::Write(const std::string& text, const std::string& ball) const {
  const fs::path beside = path_.parent_path() / BallName();
  try {
    if (!ball.empty()) WriteWhole(beside.string(), ball, Draft::Existing::kKeep);
    try {
      WriteWhole(path_.string(), text, Draft::Existing::kKeep);
    } catch (const std::runtime_error&) {
      std::error_code ignored;
      if (!ball.empty()) fs::remove(beside, ignored);
      throw;
    }
  } catch (const std::runtime_error& error) {
    throw Failure(ExitCode::kIo, error.what(), "another place for -o");
  }
}

}  // namespace regrasp::hand
