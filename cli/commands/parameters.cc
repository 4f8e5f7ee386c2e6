// Parameters: what may be changed while running.

#include "cli/commands/parameters.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "cli/client/context.h"
#include "cli/grammar/units.h"
#include "core/common/count_text.h"
#include "core/files/names.h"
#include "core/files/output_file.h"
#include "core/files/problem_list.h"
#include "core/files/toml_text.h"

namespace regrasp::cli {
namespace {

constexpr const char* kGroup = "Control";

/// As `param set` takes it: without quotes and brackets, true or false.
std::string Typed(const Json& value) {
  if (value.is_boolean()) return value.dump();
  if (!value.is_array()) return Plain(value);
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : ",") + Plain(item);
  return text;
}

/// As TOML writes it, every digit.
std::string Toml(const Json& value) {
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "[" : ", ") + item.dump();
  return text + "]";
}

std::string Range(const Json& p) {
  if (At(p, "type") == "boolean") return "true | false";
  if (At(p, "type") != "word")
    return fmt::format("{} … {}", Plain(At(p, "min")), Plain(At(p, "max")));
  std::string text;
  for (const Json& word : At(p, "words")) text += (text.empty() ? "" : " | ") + Plain(word);
  return text;
}

std::string WithUnit(const Json& p, const char* field) {
  const std::string unit = Plain(At(p, "unit"));
  return Typed(At(p, field)) + (unit.empty() ? "" : " " + unit);
}

void PrintParameter(Output& out, const Json& p) {
  out.Line(
      fmt::format("{} = {}", out.Paint(Plain(At(p, "name")), Style::kBold), WithUnit(p, "value")));
  out.Line(
      fmt::format("  default {}    ({})", WithUnit(p, "default"), Plain(At(p, "default_source"))));
  out.Line(fmt::format("  range   {}", Range(p)));
  out.Line(fmt::format("  meaning {}", Plain(At(p, "description"))));
  out.Line(fmt::format("  source  {}", Plain(At(p, "source"))));
}

void PrintTable(Context& context, const Json& answer) {
  Output& out = context.out();
  const Json& parameters = At(answer, "parameters");
  if (parameters.empty()) return out.Line("every parameter has its default");
  const bool verbose = context.options().verbose;
  std::vector<std::string> titles = {"NAME", ">VALUE", ">DEFAULT", "UNIT"};
  if (verbose) titles.insert(titles.end(), {"RANGE", "SOURCE", "MEANING"});
  Table table(titles);
  for (const Json& p : parameters) {
    const bool changed = At(p, "changed") == true;
    const Style style = changed ? Style::kWarn : Style::kPlain;
    std::vector<std::string> cells = {Plain(At(p, "name")), out.Paint(Typed(At(p, "value")), style),
                                      changed ? Typed(At(p, "default")) : "", Plain(At(p, "unit"))};
    if (verbose)
      cells.insert(cells.end(), {Range(p), Plain(At(p, "source")), Plain(At(p, "description"))});
    table.Row(cells);
  }
  out.Add(table.Text(out));
}

/// Rows for CSV: a vector, and the list of words, in one cell each.
std::vector<Json> CsvRows(const Json& parameters) {
  std::vector<Json> rows(parameters.begin(), parameters.end());
  for (Json& row : rows)
    for (const char* field : {"value", "default", "words", "before"})
      if (row.contains(field)) row[field] = Typed(row[field]);
  return rows;
}

ExitCode List(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.PrintRows(answer, CsvRows(At(answer, "parameters")),
                    [&] { PrintTable(context, answer); });
  return kOk;
}

/// "0.5N" as a number of the parameter's own unit.
Invocation InOwnUnit(Context& context, const Invocation& invocation) {
  const auto given = invocation.params.find("value");
  if (given == invocation.params.end() || !given->is_string()) return invocation;
  const std::string text = given->get<std::string>();
  if (!HasUnit(text)) return invocation;
  const Json parameter =
      context.client().Call("param.get", {{"name", At(invocation.params, "name")}});
  Invocation converted = invocation;
  converted.params["value"] =
      ParseQuantity(text, Plain(At(parameter, "name")), Plain(At(parameter, "unit")));
  return converted;
}

ExitCode GetOrSet(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(InOwnUnit(context, invocation));
  context.Print(answer, [&] { PrintParameter(context.out(), answer); });
  return kOk;
}

ExitCode Reset(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  const Json& parameters = At(answer, "parameters");
  context.PrintRows(answer, CsvRows(parameters), [&] {
    Output& out = context.out();
    if (parameters.empty()) out.Line("nothing had been changed");
    for (const Json& p : parameters)
      out.Line(fmt::format("{} = {}, before {}", Plain(At(p, "name")), WithUnit(p, "value"),
                           Typed(At(p, "before"))));
  });
  return kOk;
}

ExitCode Save(Context& context, const Invocation& invocation) {
  const bool all = invocation.Has("all");
  const Json answer = context.client().Call("param.list", {{"changed", !all}});
  const std::string file = invocation.Text("file");
  std::string text =
      "# Parameters of regraspd: for `regrasp param load FILE`, or as a part of its configuration "
      "file.\n[parameters]\n";
  for (const Json& p : At(answer, "parameters"))
    text +=
        fmt::format("\"{}\" = {}  # default {}{}{}\n", Plain(At(p, "name")), Toml(At(p, "value")),
                    Toml(At(p, "default")), At(p, "unit") == "" ? "" : " ", Plain(At(p, "unit")));
  if (file == "-") {
    context.out().Add(text);
    return kOk;
  }
  try {
    CheckWritable(file, Draft::Existing::kReplace);
    WriteWhole(file, text, Draft::Existing::kReplace);
  } catch (const std::runtime_error& error) {
    throw CliError(kIo, error.what(), "regrasp param save OTHER_FILE");
  }
  const std::size_t count = At(answer, "parameters").size();
  context.Print({{"file", file}, {"count", count}}, [&] {
    context.out().Line(fmt::format("{}: {}{}", file, CountText(count, "parameter"),
                                   all          ? ""
                                   : count == 1 ? " that differs from its default"
                                                : " that differ from their defaults"));
  });
  return kOk;
}

/// What a parameter file sets, and the line of each.
struct ParameterFile {
  Json values = Json::object();
  std::map<std::string, std::uint32_t> lines = {};
};

/// A value as the wire takes it; null for what no parameter can be.
Json ToWire(const toml::node& node) {
  if (const auto flag = node.as_boolean()) return flag->get();
  if (const auto text = node.as_string()) return text->get();
  if (node.is_number()) {
    const double number = *node.value<double>();
    return std::isfinite(number) ? Json(number) : Json();
  }
  const toml::array* items = node.as_array();
  if (!items) return {};
  Json list = Json::array();
  for (const toml::node& item : *items) list.push_back(ToWire(item));
  return list;
}

/// Names may be quoted, dotted or in sub-tables, as in the configuration file. `but`: this key is
/// passed over.
void ReadTable(const toml::table& table, const std::string& prefix, ParameterFile* read,
               std::string_view but = "") {
  for (const auto& [key, node] : table) {
    if (!but.empty() && key.str() == but) continue;
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* inner = node.as_table()) {
      ReadTable(*inner, name + ".", read);
    } else {
      read->values[name] = ToWire(node);
      read->lines[name] = node.source().begin.line;
    }
  }
}

/// Throws CliError(kUsage) for what of `root` stands outside of its table [parameters], however the
/// key is written.
void RefuseOutside(const std::string& file, const toml::table& root) {
  ParameterFile outside;
  ReadTable(root, "", &outside, "parameters");
  ProblemList problems;
  for (const auto& [name, line] : outside.lines)
    problems.Add(static_cast<int>(line),
                 fmt::format("{}:{}: {}: is outside of [parameters]; only what stands in that "
                             "table is a parameter",
                             file, line, ShownText(name)));
  if (problems.empty()) return;
  CliError refusal(kUsage, problems.Text(), "regrasp param list");
  refusal.is_list = problems.count() > 1;
  throw refusal;
}

ParameterFile ReadFile(const std::string& file) {
  if (::access(file.c_str(), R_OK) != 0)
    throw CliError(::access(file.c_str(), F_OK) == 0 ? kPermission : kNotFound,
                   fmt::format("{}: cannot be read", file), "regrasp param save " + file);
  ParameterFile read;
  std::string text;
  try {
    text = ReadTomlText(file);
  } catch (const std::runtime_error& error) {
    throw CliError(kUsage, error.what(), "regrasp param save OTHER_FILE, to see one");
  }
  try {
    const toml::table root = toml::parse(text);
    const toml::table* table = root["parameters"].as_table();
    if (!table)
      throw CliError(kUsage, fmt::format("{}: no table [parameters]", file),
                     "regrasp param save OTHER_FILE, to see one");
    RefuseOutside(file, root);
    ReadTable(*table, "", &read);
  } catch (const toml::parse_error& error) {
    throw CliError(kUsage,
                   fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()),
                   "regrasp param save OTHER_FILE, to see one");
  }
  return read;
}

/// A refusal with the places in the file of what it blames.
CliError Placed(const CliError& error, const std::string& file, const ParameterFile& read) {
  const auto line_of = [&](const CliError& one) {
    const auto line = read.lines.find(one.rpc_param);
    return line == read.lines.end() ? 0 : static_cast<int>(line->second);
  };
  const auto placed = [&](const CliError& one) -> std::string {
    if (one.rpc_param.empty()) return one.what();
    const int line = line_of(one);  // 0: the daemon does not repeat names of any length
    return fmt::format("{}{}: {}", file, line == 0 ? "" : fmt::format(":{}", line), one.what());
  };
  if (error.rpc_errors.empty()) return error.With(placed(error), error.hint);
  ProblemList problems;
  for (const CliError& one : error.rpc_errors)
    problems.Add(line_of(one), WithHint(placed(one), one.hint));
  problems.AddUnkept(error.rpc_more);
  CliError all = error.With(problems.Text(), "regrasp param list");
  all.is_list = problems.count() > 1;
  return all;
}

ExitCode Load(Context& context, const Invocation& invocation) {
  const std::string file = invocation.Text("file");
  const ParameterFile read = ReadFile(file);
  Json answer;
  try {
    answer = context.client().Call("param.load", {{"parameters", read.values}});
  } catch (const CliError& error) {
    throw Placed(error, file, read);
  }
  context.Print(answer, [&] {
    Output& out = context.out();
    const Json& parameters = At(answer, "parameters");
    if (parameters.empty()) out.Line(fmt::format("{} sets no parameter", file));
    for (const Json& p : parameters)
      out.Line(fmt::format("{} = {}", Plain(At(p, "name")), WithUnit(p, "value")));
    const Json& kept = At(answer, "kept");
    if (!kept.empty()) out.Line(fmt::format("changed before, and kept: {}", ChangedText(kept)));
  });
  return kOk;
}

}  // namespace

std::string ChangedText(const Json& changed) {
  std::string text;
  if (!changed.is_object()) return text;
  for (const auto& [name, value] : changed.items())
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", name, Typed(value));
  return text;
}

std::vector<CommandSpec> ParameterCommands() {
  CommandSpec get = MethodCommand("param.get", kGroup, GetOrSet, {.positional = {"name"}});
  get.args.front().required = true;
  get.sentence = "value, default, unit, range and source of a parameter";
  const auto file = [](const char* help) {
    return Arg{.key = "file", .flags = "", .metavar = "FILE", .help = help, .required = true};
  };
  CommandSpec list = MethodCommand("param.list", kGroup, List, {.positional = {"group"}});
  list.sentence += "; with -v their meaning";
  CommandSpec load{"param load",
                   kGroup,
                   "set the parameters that a file names",
                   nullptr,
                   {file("TOML with a table [parameters], as param save writes it")},
                   Load};
  CommandSpec save{"param save",
                   kGroup,
                   "write the changed parameters into a file",
                   nullptr,
                   {file("written whole or not at all; - is standard output"),
                    Arg{.key = "all",
                        .flags = "--all",
                        .metavar = "",
                        .kind = ArgKind::kFlag,
                        .help = "every parameter, not only those that differ from their defaults"}},
                   Save};
  return {std::move(list),
          std::move(get),
          MethodCommand("param.set", kGroup, GetOrSet, {.positional = {"name", "value"}}),
          MethodCommand("param.reset", kGroup, Reset, {.positional = {"name"}}),
          std::move(save),
          std::move(load)};
}

}  // namespace regrasp::cli
