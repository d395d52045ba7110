#pragma once

#include <string>

namespace carousel::report {

/// What docs/reference/report is written from: every item that a run prints on the terminal and every key of
/// report.json, from terminal_words() and from the meanings of the report's schema.
std::string report_markdown();

}  // namespace carousel::report
