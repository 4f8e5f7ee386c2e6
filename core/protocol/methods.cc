#include "core/protocol/methods.h"

#include <algorithm>
#include <array>

#include "core/protocol/file_rows.h"
#include "core/protocol/inspect_rows.h"
#include "core/protocol/job_rows.h"
#include "core/protocol/parameter_rows.h"
#include "core/protocol/simulation_rows.h"

namespace regrasp {
namespace {

using enum ParamType;

/// The rows of every theme, sorted by name.
template <std::size_t... n>
constexpr auto Sorted(const std::array<MethodSpec, n>&... themes) {
  std::array<MethodSpec, (n + ...)> all{};
  auto end = all.begin();
  ((end = std::ranges::copy(themes, end).out), ...);
  std::ranges::sort(all, {}, &MethodSpec::name);
  return all;
}
constexpr auto kMethods = Sorted(rows::kFileRows, rows::kInspectRows, rows::kJobRows,
                                 rows::kParameterRows, rows::kSimulationRows);

static_assert(std::ranges::is_sorted(rows::kTopics));

}  // namespace

std::string_view Name(ParamType type) {
  switch (type) {
    case kInteger:
      return "integer";
    case kNumber:
      return "number";
    case kBool:
      return "boolean";
    case kString:
      return "string";
    case kEnum:
      return "name";
    case kVector3:
      return "number[3]";
    case kParameterValue:
      return "number, number[3], boolean or word";
    case kObject:
      return "object";
    case kIntegerPair:
      return "integer[2]";
  }
  return "";
}

std::string_view Name(NameSource source) {
  switch (source) {
    case NameSource::kNone:
      return "";
    case NameSource::kFinger:
      return "finger";
    case NameSource::kObject:
      return "object";
    case NameSource::kParameter:
      return "parameter";
    case NameSource::kParameterGroup:
      return "parameter group";
    case NameSource::kParameterOrGroup:
      return "parameter or group";
  }
  return "";
}

std::span<const MethodSpec> MethodTable() { return kMethods; }

std::span<const MethodSpec> JobMethods() { return rows::kJobRows; }

const MethodSpec* FindMethod(std::string_view name) {
  const auto it = std::ranges::lower_bound(kMethods, name, {}, &MethodSpec::name);
  return it != kMethods.end() && it->name == name ? &*it : nullptr;
}

const ParamSpec* FindParam(const MethodSpec& method, std::string_view name) {
  for (const ParamSpec& param : method.params)
    if (param.name == name) return &param;
  return nullptr;
}

std::span<const std::string_view> TopicNames() { return rows::kTopics; }

}  // namespace regrasp
