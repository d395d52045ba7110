#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace carousel {

/// The last line of a list that a program writes, so that a part is not taken for the whole: `# rows: 120`, or
/// `# rows: 120, incomplete` where the run that wrote the list was interrupted.
std::string list_end(std::uint64_t rows, bool complete);

/// Finds that line while a list is read. Lists of other programs have none, and are read as they are.
class ListEnd {
 public:
  /// True if `line` is the last line of a list.
  bool take(std::string_view line);
  /// True if the line has come already.
  bool found() const { return rows_.has_value(); }
  /// The fault of a list of so many rows, in words; empty if there is none. `name`: of a row, as in "ray".
  std::string fault(std::uint64_t rows, std::string_view name) const;

 private:
  std::optional<std::uint64_t> rows_;
  bool complete_ = true;
};

}  // namespace carousel
