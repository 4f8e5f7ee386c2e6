#pragma once

/// The tables of an experiment: for people, for Markdown, for LaTeX.

#include <string>
#include <vector>

#include "cli/client/client.h"
#include "cli/print/print.h"

namespace regrasp::cli {

struct TableData {
  std::vector<std::string> titles;  ///< those that begin with '>' are aligned to the right
  std::vector<std::vector<std::string>> rows;
};

enum class TableFormat { kText, kMarkdown, kLatex };
/// "text", "markdown" or "latex".
TableFormat TableFormatOf(const std::string& word);

/// Text: aligned columns. Markdown: a GitHub table. LaTeX: a tabular with the rules of booktabs,
/// special characters escaped, φ and ± in math mode.
std::string Render(const Output& out, const TableData& table, TableFormat format);

/// One row per group of a summary (summary.h): settings, n, shares with Wilson's and medians with
/// their 95 % intervals.
TableData GroupTable(const Json& summary);
/// One row per comparison and measure: both means, difference with its 95 % interval, p, Holm's p.
TableData ComparisonTable(const Json& summary);
/// A sentence about what ComparisonTable() has no rows of; empty: nothing is left out.
std::string LeftOut(const Json& summary);
/// A sentence below a table; in LaTeX a comment.
std::string Note(const Output& out, std::string text, TableFormat format);
/// One row per predictor of a prediction: area under the ROC with its interval, how far behind the
/// best, and the share foretold with false alarms in 10 % of the windows that hold.
TableData PredictionTable(const Json& summary);
/// How many seeds each figure needs for an interval of +-`precision`: of shares and their
/// differences absolute, of all else relative to the figure. "-": all values were the same, which
/// does not tell.
TableData SampleSizeTable(const Json& summary, double precision);

}  // namespace regrasp::cli
