#pragma once

#include <string_view>

namespace carousel::app {

/// Writes results to stdout as they are: JSON, YAML, generated pages. Throws FileError if they cannot be written (disk
/// full).
void print_result(std::string_view text);

/// Writes a table or other text for people: without control characters but line ends, and with lines that fit the
/// terminal (report/text/fit_lines.h). The width is that of the terminal, or COLUMNS where it is set; lines of a file
/// or a pipe stay as they are. Throws FileError.
void print_text(std::string_view text);

}  // namespace carousel::app
