#pragma once

#include <string_view>

namespace carousel::app {

/// Writes results to stdout. Throws FileError if they cannot be written (disk full).
void print_result(std::string_view text);

}  // namespace carousel::app
