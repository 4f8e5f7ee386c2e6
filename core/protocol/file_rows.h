#pragma once

/// What writes files into the output directory: checkpoints, run files, pictures.

#include <array>
#include <string_view>

#include "core/protocol/methods.h"
#include "core/protocol/plot_table.h"

namespace regrasp::rows {

using enum ParamType;

inline constexpr ParamSpec kCheckpointName = {
    .name = "name",
    .type = kString,
    .sentence = "letters, digits, - _ . ; at most 64, neither . nor - first",
    .required = true};
inline constexpr std::array kCheckpointSave = {kCheckpointName};
inline constexpr std::array kCheckpointRestore = {
    kCheckpointName,
    ParamSpec{.name = "seed",
              .type = kInteger,
              .sentence = "branch: sensor noise and later random choices follow this seed",
              .min = 0,
              .max = kMaxSafeInteger,
              .default_text = "go on identically"},
    ParamSpec{.name = "reexecute",
              .type = kBool,
              .sentence = "execute the commands again from tick 0, rather than load the state",
              .default_text = "false"},
};
inline constexpr std::array kPlot = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the picture",
              .required = true,
              .values = kPlotNames},
    ParamSpec{.name = "file",
              .type = kString,
              .sentence = "file name (not a path), written in the daemon's output directory; its "
                          "suffix decides: .png, .jpg, .pdf, .svg",
              .default_text = "NAME.png, or NAME-2.png ... where that is there"},
    ParamSpec{.name = "overwrite",
              .type = kBool,
              .sentence = "replace a picture of this name; otherwise that is an error",
              .default_text = "false"},
    ParamSpec{.name = "last_s",
              .type = kNumber,
              .sentence = "only the last so many seconds",
              .unit = "s",
              .min = 0.1,
              .max = 600,
              .default_text = "everything kept"},
    ParamSpec{.name = "size_m",
              .type = kNumber,
              .sentence = "printed width, of text of at least 7 pt",
              .unit = "m",
              .min = 0.05,
              .max = 1,
              .default_text = "for a screen"},
    ParamSpec{.name = "title",
              .type = kBool,
              .sentence = "the picture's title and its line of facts",
              .default_text = "true"},
    ParamSpec{.name = "font_size_pt",
              .type = kNumber,
              .sentence = "with size: no text on paper is smaller",
              .unit = "pt",
              .min = 4,
              .max = 24,
              .default_text = "7"},
    ParamSpec{.name = "dpi",
              .type = kNumber,
              .sentence = "with size: pixels per inch of a .png or .jpg",
              .min = 50,
              .max = 1200,
              .default_text = "1600 pixels wide"},
};
inline constexpr std::array kRecordStart = {
    ParamSpec{.name = "file",
              .type = kString,
              .sentence = "file name (not a path), written in the daemon's output directory",
              .default_text = "run-001.mcap, or the next number"},
    ParamSpec{.name = "rate_hz",
              .sentence = "samples per second of simulated time; commands, events and state hashes "
                          "are always complete",
              .unit = "Hz",
              .min = 0.1,
              .max = 100,
              .default_text = "25"},
};

inline constexpr std::array kFileRows = {
    MethodSpec{"checkpoint.list",
               "checkpoint list",
               "the checkpoints in the output directory",
               {},
               false,
               "checkpoints: [{name, tick, time_s, state, state_hash, seed, object, commands, "
               "same_build}]"},
    MethodSpec{"checkpoint.restore", "checkpoint restore",
               "go on from a checkpoint: identically, or with another seed", kCheckpointRestore,
               true,
               "job; continues: the job that goes on after it, or null; from: state or commands; "
               "tick, state_hash; differences: the build that saved it, where that is another, and "
               "parameters that are not the defaults, a sentence each"},
    MethodSpec{"checkpoint.save", "checkpoint save",
               "keep this moment, to go on from it later; one of this name is replaced",
               kCheckpointSave, false,
               "name, tick, time_s, state, state_hash, commands, path, replaced: whether there was "
               "one of this name"},
    MethodSpec{"plot", "plot", "draw a picture into the output directory", kPlot, false,
               "file (name), path, bytes, tick"},
    MethodSpec{"record.list",
               "record list",
               "the run files in the output directory",
               {},
               false,
               "recordings: [{file, bytes, complete, recording}]"},
    MethodSpec{"record.start", "record start",
               "write the run into a file, from its beginning; it can be replayed", kRecordStart,
               false, "file, path, rate_hz, tick, commands (so far)"},
    MethodSpec{"record.stop",
               "record stop",
               "end the run file",
               {},
               false,
               "file, path, messages, bytes, dropped"},
};

}  // namespace regrasp::rows
