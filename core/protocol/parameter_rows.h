#pragma once

/// The parameters.

#include <array>

#include "core/protocol/methods.h"

namespace regrasp::rows {

using enum ParamType;

inline constexpr std::array kParamGet = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the parameter",
              .names = NameSource::kParameter,
              .default_text = "all parameters"},
};
inline constexpr std::array kParamList = {
    ParamSpec{.name = "group",
              .type = kEnum,
              .sentence = "only parameters whose names begin so: gait",
              .names = NameSource::kParameterGroup,
              .default_text = "all"},
    ParamSpec{.name = "changed",
              .type = kBool,
              .sentence = "only parameters that differ from their defaults",
              .default_text = "false"},
};
inline constexpr std::array kParamLoad = {
    ParamSpec{.name = "parameters",
              .type = kObject,
              .sentence = "values by name; all are set, or none where one is refused",
              .required = true},
};
inline constexpr std::array kParamReset = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the parameter, or the group: gait",
              .names = NameSource::kParameterOrGroup,
              .default_text = "all parameters"},
};
inline constexpr std::array kParamSet = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the parameter",
              .required = true,
              .names = NameSource::kParameter},
    ParamSpec{.name = "value",
              .type = kParameterValue,
              .sentence = "its new value, of the type and in the range that param.get tells",
              .required = true},
};

inline constexpr std::array kParameterRows = {
    MethodSpec{"param.get", "param get", "values, units, ranges and sources of parameters",
               kParamGet, false,
               "name, value, default, changed, type, unit, min, max, words, size, description, "
               "source (of the value), default_source; without a name parameters: [...]"},
    MethodSpec{"param.list", "param list", "every parameter, a group, or what has been changed",
               kParamList, false, "parameters: [{name, value, ... as param.get}]"},
    MethodSpec{"param.load", "param load", "set many parameters at once", kParamLoad, false,
               "parameters: [{name, value, ... as param.get}] that were given; kept: {NAME: value} "
               "of the others that differ from their defaults"},
    MethodSpec{"param.reset", "param reset", "set parameters back to their defaults", kParamReset,
               false, "parameters: [{name, value, before, ...}] that were changed before"},
    MethodSpec{"param.set", "param set", "change a parameter", kParamSet, false,
               "name, value, default, changed, type, unit, min, max, words, size, description, "
               "source, default_source"},
};

}  // namespace regrasp::rows
