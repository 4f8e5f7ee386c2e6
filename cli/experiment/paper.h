#pragma once

/// `regrasp experiment paper`: everything the paper shows, measured again, and a page that says so.

#include <map>
#include <string>
#include <vector>

#include "cli/client/context.h"
#include "cli/experiment/paper_parts.h"

namespace regrasp::cli {

/// Runs PaperParts(), each resumable, draws figures 1, 2, 3a and 3b and makes the 50 repetitions,
/// all into DIR/reproduction, and writes DIR/reproduction.md.
ExitCode Paper(Context& context, const Invocation& invocation);

/// What the page is made from.
struct PaperResults {
  Json figures;  ///< Figures::measured()
  std::vector<PaperPart> parts;
  std::map<std::string, Json> summaries;  ///< Summary() of each part, by its name
  Json parameters;                        ///< of the daemon: name -> value
  std::string date, command;
  std::string data;              ///< directory of the pictures and tables, relative to the page
  bool among_documents = false;  ///< experiments.md and paper_map.md are beside the page
};

/// The page, Markdown.
std::string ReproductionPage(const PaperResults& results);

}  // namespace regrasp::cli
