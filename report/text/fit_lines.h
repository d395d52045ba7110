#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace carousel::report {

/// The number of columns that UTF-8 text takes, if each character takes one.
std::size_t columns_of(std::string_view text);

/// The beginning of a text that takes at most `width` columns.
std::string cut_to(std::string_view text, std::size_t width);

/// Breaks the lines of a table that are longer than `width` columns. A line is broken at its gaps of two spaces and
/// more, or else at single ones; it goes on below its second column if it has a first one that is short. A word longer
/// than the line is cut into pieces. Widths below 20 count as 20.
std::string fit_lines(std::string_view text, std::size_t width);

}  // namespace carousel::report
