#pragma once

/// `regrasp experiment paper`: everything the paper shows, measured again, and a page that says so.

#include "cli/context.h"

namespace regrasp::cli {

/// Draws figures 1, 2, 3a and 3b, runs the 50 repetitions, explorations of all fingers, the noise
/// sweep and rotations, each resumable, into DIR/reproduction, and writes DIR/reproduction.md.
ExitCode Paper(Context& context, const Invocation& invocation);

/// What the page is made from.
struct PaperResults {
  Json figures;               ///< Figures::measured()
  Json exploration;           ///< Summary(): all fingers, both estimators, noise paper
  Json sweep;                 ///< Summary(): every preset
  Json returning, exploring;  ///< Summary(): rotations
  std::string date, command;
  std::string data;  ///< directory of the pictures and tables, relative to the page
};

/// The page, Markdown.
std::string ReproductionPage(const PaperResults& results);

}  // namespace regrasp::cli
