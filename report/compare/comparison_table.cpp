#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "report/compare/comparison.h"
#include "report/text/fit_lines.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report {

namespace {

std::string padded(const std::string& text, std::size_t width, bool right = false) {
  const std::string space(width - std::min(width, columns_of(text)), ' ');
  return right ? space + text : text + space;
}

/// "the same in all", or the runs that differ from the first.
std::string sameness(const std::vector<bool>& same) {
  std::string others;
  for (std::size_t r = 1; r < same.size(); ++r)
    if (!same[r]) others += (others.empty() ? "" : ", ") + letter(r);
  return others.empty() ? "the same" : "different: " + others + " from A";
}

/// Names of counts as words.
std::string name_text(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// Four digits and more as 40,568, and others with so many digits that count.
std::string compact(double value, int digits) {
  return value >= 999.5 && value < 0x1p53 ? grouped(static_cast<std::uint64_t>(value + 0.5))
                                          : fmt::format("{:.{}g}", value, digits);
}

std::string value_text(const ComparedRow& row, std::size_t run) {
  const std::optional<double>& value = row.values[run];
  if (!value) return "-";
  if (row.unit == "share") return percent(*value);
  if (row.unit == "bytes") return bytes_text(static_cast<std::uint64_t>(*value));
  return std::abs(*value) >= 1e6 ? scaled(*value) : compact(*value, 4);
}

std::string ratio_text(const ComparedRow& row, std::size_t run) {
  if (row.unit == "share") {
    if (!row.values[run] || !row.values[0]) return "-";
    return fmt::format("{:+.1f}", 100 * (*row.values[run] - *row.values[0]));
  }
  return row.ratios[run] ? "x" + compact(*row.ratios[run], 3) : "-";
}

/// The runs whose cycles another seed may make as many as the first run's.
std::string noise_text(const Comparison& c) {
  std::string out;
  for (std::size_t r = 1; r < c.within_noise.size(); ++r)
    if (c.within_noise[r]) out += fmt::format("noise          {}\n", noise_words(c, r));
  return out;
}

std::string section_text(const ComparedSection& section, const Comparison& of) {
  const std::size_t runs = of.runs.size();
  std::vector<std::vector<std::string>> cells{{section.name, "unit"}};
  for (std::size_t r = 0; r < runs; ++r) cells[0].push_back(letter(r));
  for (std::size_t r = 1; r < runs; ++r) cells[0].push_back(letter(r) + "/A");
  for (const ComparedRow& row : section.rows) {
    std::vector<std::string>& line = cells.emplace_back(std::vector<std::string>{name_text(row.name), row.unit});
    for (std::size_t r = 0; r < runs; ++r) line.push_back(value_text(row, r));
    for (std::size_t r = 1; r < runs; ++r)
      line.push_back((row.of_cycles && of.within_noise[r] ? "~" : "") + ratio_text(row, r));
  }
  std::vector<std::size_t> widths(cells[0].size());
  for (const auto& line : cells)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], columns_of(line[c]));
  std::string out;
  for (std::size_t l = 0; l < cells.size(); ++l) {
    out += l == 0 ? "" : "  ";
    for (std::size_t c = 0; c < cells[l].size(); ++c)
      out += padded(cells[l][c], widths[c] + (l == 0 && c == 0 ? 2 : 0), c > 1) + (c + 1 < cells[l].size() ? "  " : "");
    out += '\n';
  }
  return out + '\n';
}

std::string texts_of(const std::vector<ComparedText>& list) {
  std::size_t width = 0;
  for (const ComparedText& text : list) width = std::max(width, columns_of(text.name));
  std::string out;
  for (const ComparedText& text : list) {
    out += "  " + padded(text.name, width);
    for (const std::string& value : text.texts) out += "  " + (value.empty() ? "-" : value);
    out += '\n';
  }
  return out;
}

/// A line a fact, below one another.
std::string facts_of(const std::string& text) {
  constexpr std::string_view kBetween = "; ";
  std::string out = singular(text);
  for (std::size_t at = out.find(kBetween); at != out.npos; at = out.find(kBetween, at))
    out.replace(at, kBetween.size(), "\n" + std::string(18, ' '));
  return out;
}

/// Counts the keys that differ, those too that the pattern hides.
std::string keys_text(std::size_t shown, std::size_t hidden) {
  const std::size_t all = shown + hidden;
  std::string out = fmt::format("{} {}", all, all == 1 ? "key differs" : "keys differ");
  if (hidden > 0) out += all == hidden ? ", hidden by --only" : fmt::format(", {} of them hidden by --only", hidden);
  return out;
}

}  // namespace

std::string letter(std::size_t run) {
  return run < 26 ? std::string(1, static_cast<char>('A' + run)) : fmt::format("#{}", run + 1);
}

std::string noise_words(const Comparison& c, std::size_t run) {
  return fmt::format("{} is not told from A by its cycles: another seed of the picture changes them by up to {} (~)",
                     letter(run), percent(*c.within_noise[run]));
}

std::string comparison_table(const Comparison& c, bool all) {
  constexpr std::size_t kMostUnexpected = 20;
  if (c.identical) return "identical\n";
  const std::size_t runs = c.runs.size();
  std::string out;
  for (std::size_t r = 0; r < runs; ++r) out += fmt::format("{}  {}\n", letter(r), c.runs[r]);
  out += fmt::format("\nhits           {}\npicture        {}\n", sameness(c.same_hits), sameness(c.same_picture));
  const bool same_answers = sameness(c.same_hits) == "the same" && sameness(c.same_picture) == "the same";
  if (!c.same_configuration)
    out += fmt::format("configuration  {}\n", keys_text(c.configuration.size(), c.keys_hidden));
  else if (c.deterministic)
    out += "configuration  the same\n";
  else
    out += fmt::format("configuration  the same: {}; counts and times depend on the timing of threads\n",
                       same_answers ? "these are runs of one configuration with the same result"
                                    : "these are runs of one configuration with different results");
  for (const ComparedText& text : c.texts)
    for (std::size_t r = 0; r < runs; ++r)
      out += fmt::format("{:<13}  {}  {}\n", r == 0 ? text.name : "", letter(r),
                         text.texts[r].empty() ? "-" : facts_of(text.texts[r]));
  out += noise_text(c) + '\n';
  for (const ComparedSection& section : c.sections) out += section_text(section, c);
  if (!c.configuration.empty()) out += "configuration\n" + texts_of(c.configuration) + '\n';

  // Two runs of one machine under virtual time ought to be equal: then the values themselves are the news.
  const bool unexpected = c.same_configuration && c.deterministic;
  std::vector<ComparedText> shown;
  if (all || unexpected) shown = c.differences;
  if (!all && shown.size() > kMostUnexpected) shown.resize(kMostUnexpected);
  if (!shown.empty()) out += "values that differ\n" + texts_of(shown);
  if (shown.size() < c.differences.size())
    out += fmt::format("{} more values differ (--all, or --only PATTERN, lists them)\n",
                       c.differences.size() - shown.size());
  if ((all || unexpected) && c.values_hidden > 0)
    out += fmt::format("{} {} hidden by --only\n", c.values_hidden,
                       c.values_hidden == 1 ? "value that differs is" : "values that differ are");
  return out;
}

}  // namespace carousel::report
