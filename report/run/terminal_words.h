#pragma once

#include <string>
#include <vector>

namespace carousel::report {

/// One item of a table on the terminal, with its explanation for docs/reference/report.
struct TerminalWord {
  bool traffic = false;  ///< in the table of synthetic traffic; otherwise in that of a run of rays
  std::string line;      ///< name at the left of the line
  std::string text;      ///< as it is printed, with N for each number and * for words that vary
  std::string key;       ///< the value in report.json; empty for a number that is nowhere in it
  std::string meaning;   ///< empty: that of the key in the schema
};

/// Every item that report_table() and traffic_table() print, in their order. A test compares the list with the tables
/// of runs.
std::vector<TerminalWord> terminal_words();

}  // namespace carousel::report
