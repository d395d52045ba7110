#include "report/html/studies/compare_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/page.h"
#include "report/html/run_sections.h"

namespace carousel::report::html {

namespace {

/// "the same in all runs", or the runs that differ from the first.
std::string sameness(const std::vector<bool>& same) {
  std::string others;
  for (std::size_t r = 1; r < same.size(); ++r)
    if (!same[r]) others += (others.empty() ? "" : ", ") + letter(r);
  return others.empty() ? "the same in all runs" : "of " + others + " different from A's";
}

Html at_a_glance(const Comparison& c) {
  Html out = markup("<p class=\"verdict\">");
  if (c.identical)
    out += markup("The runs are identical.</p>\n");
  else
    out += markup("Hits are {}, the picture is {}.</p>\n", sameness(c.same_hits), sameness(c.same_picture));
  if (!c.same_configuration)
    out += markup("<p>The configurations differ in {} {}.</p>\n", c.configuration.size(),
                  c.configuration.size() == 1 ? "key" : "keys");
  else
    out += markup("<p>The configuration is the same{}.</p>\n",
                  c.deterministic ? "" : "; counts and times depend on the timing of threads");
  for (std::size_t r = 1; r < c.runs.size(); ++r)
    if (c.within_noise[r]) out += markup("<p>{}.</p>\n", noise_words(c, r));
  Table table{"runs", "The runs", {{"letter"}, {"run"}}};
  table.open = true;
  for (const ComparedText& text : c.texts) table.columns.push_back({text.name});
  for (std::size_t r = 0; r < c.runs.size(); ++r) {
    auto& row = table.rows.emplace_back(std::vector<Cell>{cell(letter(r)), cell(c.runs[r])});
    for (const ComparedText& text : c.texts) row.push_back(cell(text.texts[r].empty() ? "–" : text.texts[r]));
  }
  return out + table.html();
}

Cell value_of(const ComparedRow& row, std::size_t run) {
  const std::optional<double>& value = row.values[run];
  if (!value) return cell("–");
  if (row.unit == "share") return share(*value);
  const bool whole =
      *value >= 0 && *value < 0x1p53 && *value == static_cast<double>(static_cast<std::uint64_t>(*value));
  return cell(whole ? Json(static_cast<std::uint64_t>(*value)) : Json(*value));
}

/// The ratio to the first run; of shares the difference in points.
Cell ratio_of(const ComparedRow& row, std::size_t run, bool noise) {
  if (row.unit == "share") {
    if (!row.values[run] || !row.values[0]) return cell("–");
    return cell(fmt::format("{:+.1f} points", 100 * (*row.values[run] - *row.values[0])));
  }
  return row.ratios[run]
             ? Cell{fmt::format("{}×{:.3g}", noise && row.of_cycles ? "~" : "", *row.ratios[run]), *row.ratios[run]}
             : cell("–");
}

/// The name of a row: of the test units' cycles "box other_units" as the page of a run has it, "box: other units work".
std::string row_words(const std::string& section, const std::string& name) {
  const std::size_t space = name.find(' ');
  if (section == "cycles of the test units" && space != name.npos)
    if (const std::string use = use_words(name.substr(space + 1)); !use.empty() && !name.ends_with(" busy"))
      return words(name.substr(0, space)) + ": " + use;
  return words(name);
}

Section section_of(const ComparedSection& section, std::size_t number, const Comparison& c) {
  const std::size_t runs = c.runs.size();
  Table table{fmt::format("section-{}", number), "Runs side by side: " + section.name, {{"quantity"}, {"unit"}}};
  for (std::size_t r = 0; r < runs; ++r) table.columns.push_back({letter(r)});
  for (std::size_t r = 1; r < runs; ++r) table.columns.push_back({letter(r) + "/A"});
  bool shares = true, any_ratio = false;
  for (const ComparedRow& row : section.rows) {
    auto& cells = table.rows.emplace_back(std::vector<Cell>{cell(row_words(section.name, row.name)), cell(row.unit)});
    for (std::size_t r = 0; r < runs; ++r) cells.push_back(value_of(row, r));
    for (std::size_t r = 1; r < runs; ++r) {
      cells.push_back(ratio_of(row, r, c.within_noise[r].has_value()));
      any_ratio |= row.unit != "share" && row.ratios[r] && *row.ratios[r] > 0 && *row.ratios[r] != 1;
    }
    shares &= row.unit == "share";
  }
  Html body;
  if (shares || any_ratio)
    body = Figure{.id = "fig-" + table.id,
                  .kind = shares ? "shares" : "ratios",
                  .tables = table.id,
                  .title = capital(section.name) + (shares ? ": shares, run beside run" : ": ratio to run A"),
                  .label = "Bars, a group a row of the table below and a bar a run.",
                  .height = 100 + static_cast<int>((14 + 12 * runs) * std::min<std::size_t>(section.rows.size(), 40))}
               .html();
  std::string title = section.name;
  if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') title[0] = static_cast<char>(title[0] - 'a' + 'A');
  return {fmt::format("part-{}", number), title, body + table.html()};
}

Html texts_of(const std::string& id, const std::string& caption, const std::vector<ComparedText>& list,
              std::size_t runs) {
  Table table{id, caption, {{"key"}}};
  for (std::size_t r = 0; r < runs; ++r) table.columns.push_back({letter(r)});
  for (const ComparedText& text : list) {
    auto& row = table.rows.emplace_back(std::vector<Cell>{cell(text.name)});
    for (const std::string& value : text.texts) row.push_back(cell(value.empty() ? "–" : value));
  }
  return table.html();
}

}  // namespace

std::string compare_page(const Comparison& c, bool all) {
  const std::size_t runs = c.runs.size();
  std::vector<Section> sections{{"verdict", "At a glance", at_a_glance(c)}};
  for (std::size_t i = 0; i < c.sections.size(); ++i) sections.push_back(section_of(c.sections[i], i, c));
  sections.push_back({"configuration", "Configuration",
                      texts_of("configuration", "Keys of the configurations that differ", c.configuration, runs)});
  Html rest;
  if (all)
    rest = texts_of("differences", "All other values that differ", c.differences, runs);
  else if (!c.differences.empty())
    rest = markup("<p>{} more values differ; <code>carousel compare --all --html FILE</code> lists them here.</p>\n",
                  c.differences.size());
  sections.push_back({"differences", "Every other value", rest});
  std::string names;
  for (std::size_t r = 0; r < runs; ++r) names += (r == 0 ? "" : ", ") + letter(r) + " " + c.runs[r];
  return page_of("Carousel: runs side by side", "carousel compare, " + names, sections, Json::object(), {});
}

}  // namespace carousel::report::html
