#include "cli/experiment/plan.h"

#include <fmt/format.h>

#include "core/files/shell_word.h"

namespace regrasp::cli {

std::size_t Plan::num_units() const {
  return num_cases() * noise.size() * subjects.size() * static_cast<std::size_t>(seeds);
}

Unit Plan::unit(std::size_t index) const {
  const auto n = static_cast<std::size_t>(seeds);
  const std::size_t per_noise = n * subjects.size(), per_case = per_noise * noise.size();
  return {index / per_case, noise[index % per_case / per_noise],
          subjects[index / n % subjects.size()], first_seed + static_cast<std::int64_t>(index % n)};
}

std::size_t Plan::Grown(std::size_t index, std::int64_t of_seeds) const {
  const auto before = static_cast<std::size_t>(of_seeds);
  return index / before * static_cast<std::size_t>(seeds) + index % before;
}

Setting Plan::setting(std::size_t which) const {
  return cases.empty() ? common : Join(common, cases.at(which).setting);
}

std::vector<std::size_t> Plan::Mine() const {
  std::vector<std::size_t> mine;
  for (std::size_t i = static_cast<std::size_t>(shard) - 1; i < num_units();
       i += static_cast<std::size_t>(shards))
    mine.push_back(i);
  return mine;
}

std::string Plan::Command(const Unit& unit, const std::string& estimator) const {
  std::string text = fmt::format("regrasp experiment {}", rotation() ? "rotation" : "exploration");
  if (rotation()) {
    text += fmt::format(" --axis={} --turns {}", unit.subject, turns);
    if (speed_deg_s > 0) text += fmt::format(" --speed {}", speed_deg_s);
  } else {
    text += fmt::format(" --finger {} --criterion {} --estimator {} --rays {}", unit.subject,
                        criterion, estimator, rays);
  }
  text += fmt::format(" --noise {} --seed {} -n 1", unit.noise, unit.seed);
  for (const auto& [flag, value] : {std::pair{"hand", hand}, std::pair{"object", common.object},
                                    std::pair{"models-dir", models_dir}})
    if (!value.empty()) text += fmt::format(" --{} {}", flag, ShellWord(value));
  if (common.tilt_deg) text += fmt::format(" --tilt {}", *common.tilt_deg);
  if (common.push_n > 0) text += fmt::format(" --push {}", *common.push_n);
  for (const auto& [name, value] : common.set)
    text += " --set " + ShellWord(fmt::format("{}={}", name, value));
  if (stepper != "fast") text += " --stepper " + stepper;
  if (!cases.empty()) text += " --case " + ShellWord(Text(cases.at(unit.which)));
  return text + " -o trial";
}

std::vector<std::string> Plan::DaemonArguments(std::size_t which) const {
  std::vector<std::string> words;
  const std::string object = setting(which).object;
  for (const auto& [flag, value] : {std::pair{"--hand", hand}, std::pair{"--object", object},
                                    std::pair{"--models-dir", models_dir}})
    if (!value.empty()) words.insert(words.end(), {flag, value});
  words.insert(words.end(), {"--stepper", stepper});
  return words;
}

}  // namespace regrasp::cli
