#pragma once

#include <string>
#include <vector>

#include "cli/lab/experiment.h"

namespace strata::lab {

/// The records with columns aligned under their titles, then the remarks, for a terminal.
std::vector<std::string> TextLines(const Experiment& experiment, const Outcome& outcome);

/// A line of titles and one for each row; numbers with nine digits, empty where there is none;
/// words with commas or quotes are quoted (RFC 4180).
std::vector<std::string> CsvLines(const Records& records);

/// A section of Markdown: title, sentence, picture (a path, or empty), table, remarks.
std::vector<std::string> MarkdownLines(const Experiment& experiment, const Outcome& outcome,
                                       const std::string& picture);

}  // namespace strata::lab
