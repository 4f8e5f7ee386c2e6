#include "cli/grammar/complete.h"

#include <algorithm>
#include <chrono>
#include <span>

#include "cli/client/context.h"
#include "cli/grammar/flags.h"
#include "cli/grammar/grammar.h"
#include "core/hand/model_path.h"
#include "core/protocol/start_words.h"

namespace regrasp::cli {
namespace {

const Arg* FindFlag(std::span<const Arg> args, const std::string& word) {
  for (const Arg& arg : args)
    for (const std::string& name : Spellings(arg))
      if (name == word) return &arg;
  return nullptr;
}

/// Names that another method knows: the entries of a list, or the values of a parameter.
struct KnownElsewhere {
  std::string_view words, key, method, field;
};
constexpr KnownElsewhere kKnownElsewhere[] = {
    {"checkpoint restore", "name", "checkpoint.list", "name"},
    {"job show", "id", "job.list", "id"},
    {"job wait", "id", "job.list", "id"},
    {"job cancel", "id", "job.list", "id"},
    {"replay", "run", "record.list", "file"},
    {"export", "run", "record.list", "file"},
    {"video", "run", "record.list", "file"},
    {"plot", "run", "record.list", "file"},
    {"experiment exploration", "finger", "explore", "finger"}};

/// Options whose words the daemon checks: as another method of the wire allows them, or `words`.
struct CheckedByDaemon {
  std::string_view key, method, param;
  std::span<const std::string_view> words = {};
};
constexpr CheckedByDaemon kCheckedByDaemon[] = {
    {"noise", "noise.set", "preset"},      {"criterion", "explore", "criterion"},
    {"estimator", "explore", "estimator"}, {"clock", "", "", kClockWords},
    {"stepper", "", "", kStepperWords},
};

/// The models in the usual places that may stand for this argument. A name goes without a daemon.
std::vector<std::string> ModelNames(const CommandSpec& command, const Arg& arg) {
  const bool of_model = arg.metavar == "NAME|FILE" || arg.key == "file" || arg.key == "objects";
  const bool hand = arg.key == "hand" || command.words == "hand check";
  const bool object = arg.key == "object" || arg.key == "objects" || command.words == "object show";
  if (!of_model || !(hand || object)) return {};
  try {
    return ListModels(ModelSearchPath(), hand ? "hands" : "objects");
  } catch (const ModelError&) {  // $REGRASP_MODELS_DIR is no directory
    return {};
  }
}

/// The words read from left to right: how far the command goes, and what is still to come.
struct Reader {
  std::string path;                      ///< "noise set"
  const CommandSpec* command = nullptr;  ///< once the path is one
  std::size_t positionals = 0;           ///< already given
  std::string last_positional = {};      ///< "gait.preset" of `param set gait.preset`
  const Arg* pending = nullptr;          ///< the option whose value comes next

  std::span<const Arg> Args() const {
    return command ? std::span<const Arg>(command->args) : std::span<const Arg>();
  }
  const Arg* Flag(const std::string& word) const {
    const Arg* arg = FindFlag(Args(), word);
    return arg ? arg : FindFlag(GlobalArgs(), word);
  }
  void Read(const std::string& word) {
    if (word == "=") return;  // bash takes --option=value apart
    if (std::exchange(pending, nullptr)) return;
    if (word.starts_with("-")) {
      const Arg* arg = Flag(word);
      if (arg && arg->kind != ArgKind::kFlag) pending = arg;
      return;
    }
    const std::string longer = path.empty() ? word : path + " " + word;
    const auto found = FindCommands(longer);
    if (command || found.empty()) {
      ++positionals;
      last_positional = word;
    } else {
      path = longer;
      if (found.front()->words == longer) command = found.front();
    }
  }
};

struct Collector {
  const std::string& current;
  Candidates candidates;

  void Add(const std::string& word, const std::string& meaning) {
    const auto same = [&](const Candidate& known) { return known.word == word; };
    if (word.starts_with(current) && std::ranges::none_of(candidates.words, same))
      candidates.words.push_back({word, meaning});
  }
  void Flags(std::span<const Arg> args) {
    for (const Arg& arg : args)
      for (const std::string& name : Spellings(arg))
        if (name.starts_with("--") || current == "-") Add(name, arg.help);
  }
  void Commands(const std::string& path) {
    const std::size_t skip = path.empty() ? 0 : path.size() + 1;
    for (const CommandSpec* command : FindCommands(path)) {
      const std::string rest = command->words.substr(skip);
      const bool last = rest.find(' ') == std::string::npos;
      Add(rest.substr(0, rest.find(' ')), last ? command->sentence : "");
    }
  }
  void Words(const CommandSpec& command, const Arg& arg) {
    for (const std::string& name : ModelNames(command, arg)) Add(name, arg.help);
    for (const CheckedByDaemon& known : kCheckedByDaemon) {
      if (arg.wire || known.key != arg.key) continue;
      for (const std::string_view word : known.words) Add(std::string(word), arg.help);
      if (!known.method.empty())
        for (const auto& word : FindParam(*FindMethod(known.method), known.param)->values)
          Add(std::string(word), arg.help);
    }
  }
  void Values(const Reader& reader, const Arg& arg, const AskNames& ask) {
    const CommandSpec* command = reader.command;
    for (const std::string& value : arg.values) Add(value, arg.help);
    if (!arg.values.empty()) return;
    if (command) Words(*command, arg);
    if (arg.kind == ArgKind::kParameterValue)
      for (const std::string& word : ask("param.get", reader.last_positional)) Add(word, arg.help);
    if (arg.metavar.find("FILE") != std::string::npos || arg.metavar == "DIR" ||
        arg.metavar == "PATH")
      candidates.files = true;
    for (const KnownElsewhere& known : kKnownElsewhere)
      if (command && command->words == known.words && arg.key == known.key) {
        for (const std::string& name : ask(std::string(known.method), std::string(known.field)))
          Add(name, arg.help);
        if (arg.key == "run") {
          candidates.files = true;
          candidates.suffix = ".mcap";
        }
        return;
      }
    const MethodSpec* method = command ? command->method : nullptr;
    if (method && arg.wire && arg.kind == ArgKind::kText)
      for (const std::string& name : ask(std::string(method->name), arg.key)) Add(name, arg.help);
  }
};

}  // namespace

Candidates Complete(const std::vector<std::string>& words, const std::string& current,
                    const AskNames& ask) {
  Reader reader;
  for (const std::string& word : words) reader.Read(word);
  Collector collector{current, {}};
  if (reader.pending) {
    collector.Values(reader, *reader.pending, ask);
  } else if (current.starts_with("-")) {
    collector.Flags(reader.Args());
    collector.Flags(GlobalArgs());
  } else if (!reader.command) {
    if (reader.positionals == 0) collector.Commands(reader.path);
  } else if (reader.path == "help") {
    // The words of a command, one after the other.
    const auto help = std::ranges::find(words, "help");
    std::string topic;
    for (auto word = help + 1; word < words.end(); ++word)
      topic += (topic.empty() ? "" : " ") + *word;
    const auto found = FindCommands(topic);
    if (found.empty() || found.front()->words != topic) collector.Commands(topic);
  } else {
    std::size_t index = 0;
    for (const Arg& arg : reader.command->args)
      if (arg.flags.empty() && index++ == reader.positionals) collector.Values(reader, arg, ask);
  }
  return std::move(collector.candidates);
}

AskNames AskDaemon(const std::string& socket, double patience_s) {
  const auto deadline = Deadline(patience_s);
  return [=](const std::string& method, const std::string& param) {
    std::vector<std::string> names;
    const auto left = [&] {
      return std::max(1e-3, std::chrono::duration<double>(deadline - Clock::now()).count());
    };
    try {
      Client client(ClientSocket(socket), left());
      if (method.ends_with(".list")) {
        const Json list = client.Call(method, Json::object(), left());
        for (const Json& row : *list.begin()) names.push_back(Plain(At(row, param.c_str())));
        return names;
      }
      if (method == "param.get") {
        const Json row = client.Call(method, {{"name", param}}, left());
        for (const auto& word : row.value("words", Json::array())) names.push_back(word);
        if (At(row, "type") == "boolean") names = {"false", "true"};
        return names;
      }
      const Json answer = client.Call("describe", {{"method", method}}, left());
      for (const auto& spec : At(answer["methods"][0], "params"))
        if (At(spec, "name") == param)
          for (const auto& value : At(spec, "values")) names.push_back(value.get<std::string>());
    } catch (const std::exception&) {
      // No daemon, or none that answers in time: the words of the grammar are all there is.
    }
    return names;
  };
}

std::string CompletionLines(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return {};
  const std::vector<std::string> words(arguments.begin(), arguments.end() - 1);
  std::string socket;
  constexpr std::string_view kAssigned = "--socket=";
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with(kAssigned)) socket = words[i].substr(kAssigned.size());
    if (words[i] != "-s" && words[i] != "--socket") continue;
    if (i + 1 < words.size() && words[i + 1] == "=") ++i;  // bash takes --socket=PATH apart
    if (i + 1 < words.size()) socket = words[i + 1];
  }
  const std::string current = arguments.back() == "=" ? "" : arguments.back();
  const Candidates found = Complete(words, current, AskDaemon(socket));
  std::string text = found.files ? ":files" + found.suffix + "\n" : "";
  for (const Candidate& candidate : found.words)
    text += candidate.word + "\t" + candidate.meaning + "\n";
  return text;
}

}  // namespace regrasp::cli
