#pragma once

#include <string>

namespace carousel::report {

/// docs/reference/report.md: every item that a run prints on the terminal and every key of report.json, from
/// terminal_words() and from the meanings of the report's schema.
std::string report_markdown();

}  // namespace carousel::report
