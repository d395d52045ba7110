#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/ratio.h"

namespace carousel::report {

/// The lines that a run prints.
class Table {
 public:
  /// A line that begins with a name on the left; an empty name continues the last one.
  template <class... Args>
  void line(std::string_view name, fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), "{:<13}", name);
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
    out_ += '\n';
  }
  void gap() { out_ += '\n'; }
  void text(std::string_view lines) { out_ += lines; }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// A text on lines of some 110 columns, parted at `separator`. The first begins with a name.
inline void wrapped_lines(Table& table, std::string_view name, std::string_view text, std::string_view separator) {
  for (; !text.empty(); name = "") {
    const std::size_t at = text.size() <= 100 ? text.npos : text.rfind(separator, 100);
    const std::size_t mark = separator.find_last_not_of(' ') + 1;  // a comma stays at the end of its line
    table.line(name, "{}", text.substr(0, at == text.npos ? at : at + mark));
    text.remove_prefix(at == text.npos ? text.size() : at + separator.size());
  }
}

/// Names with values, side by side on one line.
class Items {
 public:
  void add(std::string_view name, std::string_view value) {
    fmt::format_to(std::back_inserter(text_), "{}{} {}", text_.empty() ? "" : "   ", name, value);
  }
  const std::string& text() const { return text_; }

  void lines(Table& table, std::string_view name) const { wrapped_lines(table, name, text_, "   "); }

 private:
  std::string text_;
};

/// Least, mean and greatest value of some parts: their balance without a line for each. No parts have no line.
template <class Part, class Value>
void spread_line(Table& table, std::string_view name, std::span<const Part> parts, const Value& value) {
  if (parts.empty()) return;
  std::uint64_t least = value(parts.front()), most = least, sum = 0;
  for (const Part& part : parts) {
    least = std::min(least, value(part));
    most = std::max(most, value(part));
    sum += value(part);
  }
  const double mean = ratio(sum, parts.size());
  table.line("", "{:<18} {:>14} {:>14} {:>14}   {:.2f}", name, grouped(least),
             grouped(static_cast<std::uint64_t>(mean + 0.5)), grouped(most), ratio(double(most), mean));
}

}  // namespace carousel::report
