#include "cli/experiment/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "cli/client/errors.h"
#include "cli/print/print.h"
#include "core/common/fnv1a.h"
#include "core/files/draft.h"
#include "core/files/read_file.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlanFile = "experiment.json";
constexpr const char* kOther = "the same command with -o OTHER_DIR";
constexpr const char* kTrialsFile = "trials.jsonl";
constexpr const char* kCheck = "check";
constexpr std::uint64_t kMost = 4ULL << 30;  // of a file [bytes]

std::string Look(const fs::path& path) { return "ls -ld " + path.parent_path().string(); }

CliError IoError(const std::string& what, const fs::path& path) {
  return {errno == EACCES ? kPermission : kIo,
          fmt::format("cannot {} {}: {}", what, path.string(), std::strerror(errno)), Look(path)};
}

void WriteAll(int fd, const std::string& text, const fs::path& path) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw IoError("write", path);
    done += static_cast<std::size_t>(n);
  }
}

std::string ReadFile(const fs::path& path) {
  try {
    return ReadRegularFile(path, kMost);
  } catch (const std::runtime_error& error) {
    throw CliError(errno == EACCES ? kPermission : kIo, error.what(), Look(path));
  }
}

/// What a line of trials.jsonl ends with: FNV-1a of the experiment's key and the line without it.
std::string CheckOf(const std::string& key, const Json& line) {
  return fmt::format("{:016x}", Fnv1a(key + line.dump()));
}

/// Null unless the line is whole, as it was written, and of the experiment with this key.
Json Whole(const std::string& key, const std::string& text) {
  Json line = Json::parse(text, nullptr, false);
  if (!line.is_object() || !line.contains(kCheck)) return nullptr;
  const Json check = line[kCheck];
  line.erase(kCheck);
  return check == CheckOf(key, line) ? line : Json();
}

UnitResult ResultOf(const Json& line) {
  return {line.at("rows").get<std::vector<Json>>(), At(line, "map")};
}

/// Ends a line that a crash cut off, so that the next one begins on its own.
void EndLastLine(int fd, const fs::path& path) {
  const off_t size = ::lseek(fd, 0, SEEK_END);
  char last = '\n';
  if (size > 0 && ::pread(fd, &last, 1, size - 1) == 1 && last != '\n') WriteAll(fd, "\n", path);
}

}  // namespace

Plan ReadPlan(const fs::path& directory) {
  const fs::path path = directory / kPlanFile;
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    throw CliError(kNotFound, fmt::format("{} holds no experiment", directory.string()),
                   "regrasp help experiment");
  return PlanFromJson(Json::parse(ReadFile(path), nullptr, false), path.string());
}

Trials ReadTrials(const fs::path& directory, const Plan& plan) {
  Trials trials;
  const fs::path path = directory / kTrialsFile;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return trials;
  const std::string key = KeyOf(plan);
  std::istringstream file(ReadFile(path));
  for (std::string line; std::getline(file, line);) {
    const Json json = Whole(key, line);
    if (!At(json, "unit").is_number_unsigned() || !At(json, "rows").is_array()) continue;
    const std::int64_t seeds = json.value("seeds", plan.seeds);
    if (seeds < 1 || seeds > plan.seeds) continue;
    const std::size_t unit = plan.Grown(json["unit"], seeds);
    if (unit < plan.num_units()) trials[unit] = ResultOf(json);
  }
  return trials;
}

void WriteFile(const fs::path& path, const std::string& text) {
  errno = 0;
  try {
    WriteWhole(path, text, Draft::Existing::kReplace);
  } catch (const std::runtime_error& error) {
    throw CliError(errno == EACCES ? kPermission : kIo, error.what(), Look(path));
  }
}

Store::Store(fs::path directory, const Plan& plan)
    : directory_(std::move(directory)), key_(KeyOf(plan)), seeds_(plan.seeds) {
  std::error_code error;
  fs::create_directories(directory_, error);
  if (error)
    throw CliError(kIo, fmt::format("cannot make {}: {}", directory_.string(), error.message()),
                   kOther);
  lock_ = ::open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) throw IoError("open", directory_);
  try {
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0)
      throw CliError(kRefused,
                     fmt::format("another experiment is running in {}", directory_.string()),
                     kOther);
    if (!fs::exists(directory_ / kPlanFile)) {
      WriteFile(directory_ / kPlanFile, ToJson(plan).dump(1) + "\n");
    } else {
      Plan before = ReadPlan(directory_);
      const bool grows = before.seeds < plan.seeds && before.shards == 1 && plan.shards == 1;
      if (grows) before.seeds = plan.seeds;
      std::string difference = Difference(before, plan);
      if (difference.empty() && (before.shard != plan.shard || before.shards != plan.shards))
        difference = fmt::format("shard was {}/{}, is {}/{}", before.shard, before.shards,
                                 plan.shard, plan.shards);
      if (!difference.empty())
        throw CliError(
            kRefused,
            fmt::format("{} holds another experiment: {}", directory_.string(), difference),
            kOther);
      if (grows) WriteFile(directory_ / kPlanFile, ToJson(plan).dump(1) + "\n");
    }
    trials_ = ReadTrials(directory_, plan);
    const fs::path path = directory_ / kTrialsFile;
    file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file_ < 0) throw IoError("write", path);
    EndLastLine(file_, path);
  } catch (...) {
    if (file_ >= 0) ::close(file_);
    ::close(lock_);
    throw;
  }
}

Store::~Store() {
  ::close(file_);
  ::close(lock_);
}

void Store::Add(std::size_t unit, const UnitResult& result) {
  Json whole = {{"unit", unit}, {"seeds", seeds_}, {"rows", result.rows}, {"map", result.map}};
  whole[kCheck] = CheckOf(key_, whole);
  const std::string line = whole.dump() + "\n";
  WriteAll(file_, line, directory_ / kTrialsFile);
  // As it will be read again, so that a run in one go and one in two give the same bytes.
  trials_[unit] = ResultOf(Json::parse(line));
}

}  // namespace regrasp::cli
