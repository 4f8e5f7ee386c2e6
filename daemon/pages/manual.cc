#include "daemon/pages/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <vector>

#include "core/protocol/errors.h"
#include "daemon/config/config.h"
#include "daemon/pages/protocol_page.h"
#include "daemon/requests/service.h"

namespace regrasp {
namespace {

/// Inline Markdown (code, bold) as scdoc writes it.
std::string Inline(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '`') {
      out += '*';
    } else if (text.substr(i, 2) == "**") {
      out += '*';
      ++i;
    } else {
      if (text[i] == '_' || text[i] == '*' || text[i] == '\\') out += '\\';
      out += text[i];
    }
  }
  return out;
}

std::string Upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

/// "| a | b | | c |" -> {"a", "b", "", "c"}; a bar inside code does not occur.
std::vector<std::string> Cells(const std::string& row) {
  std::vector<std::string> cells;
  for (std::size_t begin = 1; begin < row.size();) {
    const std::size_t end = std::min(row.find('|', begin), row.size());
    std::string cell = row.substr(begin, end - begin);
    cell.erase(0, cell.find_first_not_of(' '));
    cell.erase(cell.find_last_not_of(' ') + 1);
    cells.push_back(std::move(cell));
    begin = end + 1;
  }
  return cells;
}

/// A row of a table as an item of a list: the first cell, then the others that hold something.
std::string Item(const std::string& row, const std::vector<std::string>& titles) {
  const std::vector<std::string> cells = Cells(row);
  std::vector<std::string> rest;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const bool named = titles[i] == "default" && cells[i] != "required";
    if (!cells[i].empty()) rest.push_back((named ? "default " : "") + Inline(cells[i]));
  }
  const std::string first =
      cells[0].front() == '`' ? Inline(cells[0]) : fmt::format("*{}*", cells[0]);
  return fmt::format("- {}: {}\n", first, fmt::join(rest, "; "));
}

/// The Markdown of the protocol page: headings, paragraphs, lists, tables, literal blocks.
std::string FromMarkdown(const std::string& page) {
  std::istringstream lines(page);
  std::string out, line;
  bool literal = false;
  std::vector<std::string> titles;  // of the table that is being read
  while (std::getline(lines, line)) {
    if (line.starts_with("```")) {
      literal = !literal;
      out += "```\n";
    } else if (literal) {
      for (const char c : line) out += c == '\\' ? std::string("\\\\") : std::string(1, c);
      out += "\n";
    } else if (line.starts_with("# ") || line.starts_with("<!--")) {
      continue;  // the title; a remark
    } else if (line.starts_with("### ")) {
      out += "## " + Inline(line.substr(4)) + "\n";
    } else if (line.starts_with("## ")) {
      out += "# " + Upper(line.substr(3)) + "\n";
    } else if (line.starts_with("|")) {
      if (titles.empty())
        titles = Cells(line);
      else if (!line.starts_with("|---"))
        out += Item(line, titles);
      continue;
    } else {
      out += Inline(line) + "\n";
    }
    titles.clear();
  }
  // Headings have no markup of their own.
  for (std::size_t at; (at = out.find("\n## *")) != std::string::npos;) {
    out.erase(at + 4, 1);
    out.erase(out.find('*', at + 4), 1);
  }
  return out;
}

std::string Header(const char* name, int section, const char* sentence) {
  return fmt::format("{}({}) \"\" \"regrasp\"\n\n# NAME\n\n{} - {}\n\n", name, section, name,
                     sentence);
}

std::string KeySection(const ConfigKey& key, const DaemonConfig& built_in) {
  std::string flag = fmt::format("*{}*", FlagOf(key));
  if (!key.metavar.empty()) flag += fmt::format(" _{}_", key.metavar);
  const std::string value = key.get(built_in);
  return fmt::format(
      "{}\n\t{}{}{}. In the file *{}*, in the environment *{}*{}.\n\n", flag,
      static_cast<char>(std::toupper(static_cast<unsigned char>(key.sentence.front()))),
      Inline(key.sentence.substr(1)), value.empty() ? "" : fmt::format(" (built in: {})", value),
      Inline(key.name), Inline(VariableOf(key)), key.live ? "; a reload changes it" : "");
}

constexpr const char* kSynopsis = R"(# SYNOPSIS

*regraspd* [_OPTION_]...

# EXAMPLES

```
regraspd                                     in real time, until Ctrl-C
regraspd --speed max --seed 7                as fast as it can
regraspd --print-default-config > hand.toml  every key with its built-in value
regraspd --config hand.toml --check-config   is the file right?
```

# DESCRIPTION

*regraspd* simulates a hand that holds an object it knows nothing about, runs the controller that
grasps, explores and turns it, and answers on a Unix socket (*regrasp-protocol*(7)). *regrasp*(1) is
its command line; *regrasp up* starts a private *regraspd* in the background.

It needs no file at all. A flag beats the environment, which beats the configuration file, which
beats what is built in; *regrasp config show --origin* tells where each value comes from.

# OPTIONS

*--config* _FILE.toml_
	The configuration file. Otherwise *$REGRASP\_CONFIG*, else the first that exists of
	_~/.config/regrasp/regraspd.toml_ and _/etc/regrasp/regraspd.toml_.

)";

constexpr const char* kRest = R"(*--check-config*
	Check configuration and models, then exit.

*--bench* _S_
	Measure what a tick costs, _S_ seconds holding and _S_ seconds exploring, print JSON, then exit
	(*regrasp bench* shows it).

*--print-default-config*
	Print a configuration file with every key, then exit.

*--print-config*
	Print as JSON what is in force and where it comes from, then exit.

*--print-protocol*, *--print-protocol-manual*, *--print-manual*
	Print the protocol page in Markdown, or the source of *regrasp-protocol*(7) or of this page, then
	exit.

*--until-eof*
	Stop when standard input ends. A program that starts a daemon for itself keeps the other end of a
	pipe, and the daemon goes with it, however it ends.

*--version*
	Print the version, then exit.

# CONFIGURATION

TOML. Unknown keys and values out of range are errors that name file, line and the nearest name.
Parameters of the simulation and the controller stand in the table *[parameters]*; *regrasp param
list* shows them with unit and range.

```
speed = "max"
noise = "fine"
[parameters]
object.friction = 0.6
```

# SIGNALS

*SIGTERM*, *SIGINT*
	Answer what was asked, then stop.

*SIGHUP*
	Read the configuration again. Noise, parameters, number of clients and level of the log change at
	once, by the same commands a client would give; the log names what needs a restart. A file with an
	error changes nothing. When the terminal it was started from has gone, it stops.

# SYSTEMD

```
systemctl enable --now regraspd.socket
```

listens on _/run/regrasp/regrasp.sock_, for root, and starts the daemon at the first command. It
reports readiness, state (*systemctl status regraspd*) and reloads, and takes a socket that is handed
over. The watchdog is fed only while the simulation advances, or while it stands still on purpose: a
control loop that is stuck or has faulted ends in a restart. The service has no network, no devices,
no capabilities and writes only _/var/lib/regrasp_. Its configuration is
_/etc/regrasp/regraspd.toml_.

# FILES

_$XDG\_RUNTIME\_DIR/regrasp/regrasp.sock_, _/run/regrasp/regrasp.sock_, _/tmp/regrasp-UID/regrasp.sock_
	The socket: the first place that can be used. Mode 0600 in a directory of mode 0700; a stale one is
	taken over, anything that is not a socket is left alone.

_$XDG\_CONFIG\_HOME/regrasp/regraspd.toml_, _/etc/regrasp/regraspd.toml_
	The configuration: the first that is there. *XDG\_CONFIG\_HOME* is _~/.config_ where it is not set.

_$XDG\_STATE\_HOME/regrasp_, else _/tmp/regrasp-UID/output_
	Pictures and other results, unless *output\_dir* says where. *XDG\_STATE\_HOME* is _~/.local/state_
	where it is not set; _/tmp_ is for users without a home.

_/usr/share/regrasp/models_
	Hands and objects.

A variable above that is no absolute path counts as not set. In the configuration *socket*,
*output\_dir* and *models\_dir* are absolute, or begin with _~/_.

# EXIT STATUS

)";

}  // namespace

std::string DaemonManual() {
  std::string page = Header("regraspd", 8, "a simulated hand as a service") + kSynopsis;
  const DaemonConfig built_in;
  for (const ConfigKey& key : ConfigKeys()) page += KeySection(key, built_in);
  page += kRest;
  for (const ExitInfo& info : ExitTable())
    if (info.code != ExitCode::kNoDaemon && info.code != ExitCode::kInterrupted)
      page += fmt::format("*{}*\n\t{}\n\n", static_cast<int>(info.code), Inline(info.sentence));
  return page + "# SEE ALSO\n\n*regrasp*(1), *regrasp-protocol*(7), *systemctl*(1)\n";
}

std::string ProtocolManual() {
  return Header("regrasp-protocol", 7, "what regraspd and its clients say to each other") +
         "# DESCRIPTION\n\n" + FromMarkdown(ProtocolPage()) +
         "\n# SEE ALSO\n\n*regrasp*(1), *regraspd*(8)\n";
}

}  // namespace regrasp
