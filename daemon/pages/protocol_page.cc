#include "daemon/pages/protocol_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <string_view>

#include "core/common/limit_text.h"
#include "core/exploration/criterion.h"
#include "core/journal/run_messages.h"
#include "core/protocol/errors.h"
#include "core/protocol/methods.h"
#include "core/quality/measures.h"
#include "core/session/parameter_value.h"
#include "daemon/wire/rpc.h"

namespace regrasp {
namespace {

constexpr const char* kIntroduction = R"(# Protocol

<!-- Made by `regraspd --print-protocol`. Change core/protocol/*_rows.h or daemon/pages/protocol_page.cc, not this page. -->

JSON-RPC 2.0 over a Unix stream socket: UTF-8, one object (or one batch of at most {batch}) per line. Try it:

```
$ echo '{{"jsonrpc":"2.0","id":1,"method":"status"}}' | nc -U -N "$XDG_RUNTIME_DIR/regrasp/regrasp.sock"
```

```python
import json, os, socket
s = socket.socket(socket.AF_UNIX)
s.connect(os.environ["XDG_RUNTIME_DIR"] + "/regrasp/regrasp.sock")
s.sendall(b'{{"jsonrpc":"2.0","id":1,"method":"grasp"}}\n')
for line in s.makefile():
    print(json.loads(line))
```

- **Lines.** A trailing `\r` and blank lines are ignored. A line has at most {bytes} bytes and {depth} nested levels;
  a longer line is answered with -32011 and the connection is closed. A line with a NUL byte is refused.
- **Requests.** Parameters are given by name. `id` is a string of at most {id} bytes or an integer within ±2^53; a
  request without `id` is a notification and gets no answer. Duplicate keys, unknown parameters and numbers that
  are not finite are errors, and nothing has changed.
- **Answers** come in the order of the requests of a connection. The answer to a command is sent when the command
  has been taken up, within one tick: what is asked next sees its effect. While the simulation is paused,
  commands wait for the next tick stepped; `reset` acts at once. With a lockstep clock (`--clock lockstep`, the
  default of `regrasp up --speed max`) time advances only while a job runs or a `step` asks: a command given
  between jobs takes effect at once, at the tick where the last one ended, so that the same requests give the same
  bits. One given while a job runs takes effect at whatever tick it meets.
- **Jobs.** Long work answers `{{"job": n}}` at once. `job.wait` is the only answer that others may overtake.
- **Subscriptions.** `subscribe` answers `{{"sub": n}}`; then come notifications `event` with `sub`, `topic`, `seq` (from 1),
  `dropped` (samples left out so far), `t_s` (simulated time) and the fields of the topic. Samples are sent when there
  is something new, at most `rate_hz` times per second, and while time stands still the same again at that rate. Events are queued, samples are not.
- **Slow clients.** Requests of a client wait while it has more than 256 KiB of unread answers. A client that leaves
  1 MiB of events unread, or reads nothing for {stall} s although answers are there, is disconnected.
- **Long answers.** A line of answers has at most {answer} bytes; what would make it longer is answered with -32011,
  and the connection stays.
- **Files.** Names only; they are written to `output_dir` (see `status`).
- **Units.** Field names carry them: `_m`, `_rad`, `_n`, `_s`, ... Vectors are in the world frame W, which is the
  palm's frame; manipulability is in 1e-4 m³.
- **Access.** The socket is 0600 in a directory 0700; clients of other users (root excepted) get -32005.

)";

const char* Article(std::string_view noun) {
  return std::string_view("aeiou").find(noun.front()) == std::string_view::npos ? "a" : "an";
}

std::string Limits(const ParamSpec& spec) {
  const bool low = spec.min > -1e299, high = spec.max < 1e299;
  if (!spec.values.empty()) return fmt::format("`{}`", fmt::join(spec.values, "`, `"));
  if (spec.names != NameSource::kNone)
    return fmt::format("the name of {} {}", Article(Name(spec.names)), Name(spec.names));
  if (low && high) return fmt::format("{} ... {}", LeastText(spec.min), MostText(spec.max));
  return {};
}

std::string MethodSection(const MethodSpec& method) {
  std::string text = fmt::format(
      "### `{}`\n\n{}{}. Command line: `regrasp {}`.\n", method.name,
      static_cast<char>(std::toupper(static_cast<unsigned char>(method.sentence.front()))),
      method.sentence.substr(1), method.words);
  if (!method.params.empty())
    text +=
        "\n| parameter | type | unit | allowed | default | meaning |\n|---|---|---|---|---|---|\n";
  for (const ParamSpec& spec : method.params)
    text +=
        fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", spec.name, Name(spec.type), spec.unit,
                    Limits(spec), spec.required ? "required" : spec.default_text, spec.sentence);
  std::string answer(method.result);
  if (method.job) answer.insert(answer.find("job") + 3, " (a number; the record is in `job.get`)");
  text += fmt::format("\nAnswer: {}.\n\n", answer);
  return text;
}

std::string ParameterSection() {
  std::string text =
      "## Parameters\n\nWhat `param.set` and the table `[parameters]` of the configuration file "
      "take. Defaults of `object` and `gravity` are the model's.\n\n"
      "| name | type | unit | allowed | default | meaning | source of the default |\n"
      "|---|---|---|---|---|---|---|\n";
  const Parameters defaults;
  for (const ParameterInfo& info : ParameterTable()) {
    const std::string allowed =
        info.words.empty() ? info.type == ParameterType::kBoolean
                                 ? "`true`, `false`"
                                 : fmt::format("{} ... {}", LeastText(info.min), MostText(info.max))
                           : fmt::format("`{}`", fmt::join(info.words, "`, `"));
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", info.name, Name(info.type),
                        info.unit, allowed, ParameterText(info, info.get(defaults)), info.meaning,
                        info.source);
  }
  return text + "\n";
}

std::string MeasureSection() {
  std::string text =
      "## Measures of stability\n\nEach is in the answer of `quality` by its name; "
      "`control.stability_measure` selects the one that stability means.\n\n"
      "| name | meaning | how often | exploration may maximise it |\n|---|---|---|---|\n";
  for (const MeasureInfo& info : kMeasureTable)
    text += fmt::format("| `{}` | {} | {} | {} |\n", info.name, info.meaning,
                        info.cost == MeasureCost::kTick     ? "of the tick that is told"
                        : info.cost == MeasureCost::kSpread ? "every 0.1 s or so"
                                                            : "when asked for",
                        info.cost == MeasureCost::kTick ? "yes" : "no: too slow for a tick");
  text += "\nWhat `explore` may maximise (`criterion`):\n\n| name | meaning |\n|---|---|\n";
  for (const CriterionInfo& info : kCriterionTable)
    text += fmt::format("| `{}` | {} |\n", info.name, info.meaning);
  return text + "\n";
}

}  // namespace

std::string ProtocolPage() {
  using fmt::arg;
  std::string page =
      fmt::format(kIntroduction, arg("batch", kMaxBatch), arg("bytes", kMaxRequestBytes),
                  arg("depth", kMaxRequestDepth), arg("id", kMaxIdBytes),
                  arg("stall", kMaxOutputStallSeconds), arg("answer", kMaxAnswerBytes));
  page += "## Methods\n\n";
  for (const MethodSpec& method : MethodTable()) page += MethodSection(method);
  page +=
      "## A job's record\n\n"
      "`id, method, state` (`queued`, `running`, `done`, `failed`, `cancelled`)`, error, progress` "
      "(0 ... 1)`, "
      "start_tick, end_tick, started_s, ended_s` (the same moments in simulated seconds)`, "
      "finished, incident` (the record of a drop in it, or null), "
      "and what its method says above.\n\n";
  page += ParameterSection() + MeasureSection();
  page += "## Fields of run files\n\n" + RunFieldTable() + "\n";
  page +=
      "## Errors\n\n`{\"code\", \"message\", \"data\": {\"hint\", \"param\", \"allowed\", "
      "\"errors\", \"more\"}}`; "
      "where `param.load` refuses several values, `errors` holds the error of each (the first 50 "
      "by "
      "name; `more` is the number of the others), and the rest blames the first; `code` is theirs "
      "where they share one, else -32602.\n\n"
      "| code | name | `regrasp` exits with | when |\n|---|---|---|---|\n";
  for (const ErrorInfo& info : ErrorTable())
    page += fmt::format("| {} | {} | {} | {} |\n", static_cast<int>(info.code), info.name,
                        static_cast<int>(info.exit_code), info.sentence);
  return page;
}

}  // namespace regrasp
