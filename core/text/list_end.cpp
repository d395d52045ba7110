#include "core/text/list_end.h"

#include <charconv>

#include <fmt/format.h>

namespace carousel {

namespace {

constexpr std::string_view kBegin = "# rows: ", kIncomplete = ", incomplete";

}  // namespace

std::string list_end(std::uint64_t rows, bool complete) {
  return fmt::format("{}{}{}", kBegin, rows, complete ? "" : kIncomplete);
}

bool ListEnd::take(std::string_view line) {
  if (!line.starts_with(kBegin)) return false;
  line.remove_prefix(kBegin.size());
  const bool complete = !line.ends_with(kIncomplete);
  if (!complete) line.remove_suffix(kIncomplete.size());
  std::uint64_t rows = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), rows);
  if (error != std::errc{} || end != line.data() + line.size()) return false;
  rows_ = rows;
  complete_ = complete;
  return true;
}

std::string ListEnd::fault(std::uint64_t rows, std::string_view name) const {
  if (!complete_)
    return fmt::format(
        "the run that wrote this list was interrupted; expected the list of a whole run, found the "
        "first {} {}s; without this line they are read",
        *rows_, name);
  if (rows_ && *rows_ != rows)
    return fmt::format("this line says that the list holds {} {}s; expected as many, found {}", *rows_, name, rows);
  return rows == 0 ? fmt::format("expected at least one {}, found none", name) : "";
}

}  // namespace carousel
