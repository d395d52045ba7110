#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>

namespace carousel::report {

/// The columns that a line may have: COLUMNS where the environment sets it, or else those of the terminal that `out`
/// is; empty if it is none.
std::optional<std::size_t> terminal_width(std::FILE* out);

}  // namespace carousel::report
