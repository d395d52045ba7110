#include "report/html/html.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report::html {

namespace {

std::string with_sign(std::int64_t value) {
  // Without an overflow for the least number.
  return value < 0 ? "−" + grouped(-static_cast<std::uint64_t>(value)) : grouped(static_cast<std::uint64_t>(value));
}

std::string real_text(double value) {
  const double size = std::abs(value);
  if (!(size < 0x1p53)) return fmt::format("{:.4g}", value);
  if (size >= 1000) return with_sign(std::llround(value));
  if (size != 0 && size < 0.001) return fmt::format("{:.3g}", value);
  return fmt::format("{:.{}f}", value, size >= 100 || size == 0 ? 1 : size >= 0.1 ? 2 : 5);
}

/// Of a unit that depends on the engine, such as attempts|cycles, the one of a row: only a simulated one has cycles.
std::string one_unit(const std::string& unit, const Json& row) {
  const std::size_t bar = unit.find('|');
  if (bar == unit.npos) return unit;
  return row.contains("cycles") || row.contains("units") ? unit.substr(bar + 1) : unit.substr(0, bar);
}

void add_values(Table& table, const std::string& path, const Json& value, const Json& schema) {
  const auto properties = schema.find("properties");
  for (const auto& [key, below] : value.items()) {
    const bool known = properties != schema.end() && properties->contains(key);
    const Json& about = known ? (*properties)[key] : Json::object();
    const std::string name = path.empty() ? key : path + "." + key;
    if (below.is_object()) add_values(table, name, below, about);
    if (below.is_structured()) continue;
    const std::string unit = about.value("unit", "");
    table.rows.push_back({cell(name), cell(below, unit), cell(unit), cell(about.value("description", ""))});
  }
}

}  // namespace

std::string words(std::string_view key) {
  std::string out(key);
  for (char& c : out)
    if (c == '_') c = ' ';
  // Abbreviations are written as their field does.
  for (const auto& [small, great] : {std::pair{"dram", "DRAM"}, {"l1", "L1"}, {"l2", "L2"}})
    if (out == small || out.starts_with(small + std::string(" ")))
      out.replace(0, std::string_view(small).size(), great);
  return out;
}

std::string sentence_words(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    const std::size_t dot = word.find('.');
    const bool key =
        dot + 1 < word.size() && dot != word.npos && std::isalpha(static_cast<unsigned char>(word[dot + 1]));
    out += key ? std::string(word) : words(word);
    if (end < text.size()) out += ' ';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string value_text(const Json& value, std::string_view unit) {
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() && unit == "fraction") return percent(value.get<double>());
  if (value.is_number_unsigned()) return grouped(value.get<std::uint64_t>());
  if (value.is_number_integer()) return with_sign(value.get<std::int64_t>());
  if (value.is_number()) return real_text(value.get<double>());
  return value.dump();
}

const Json* find(const Json& json, std::string_view path) {
  const Json* at = &json;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    if (!at->is_object()) return nullptr;
    const auto found = at->find(path.substr(0, dot));
    if (found == at->end()) return nullptr;
    at = &*found;
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return at;
}

double number_at(const Json& json, std::string_view path, double otherwise) {
  const Json* value = find(json, path);
  return value && value->is_number() ? value->get<double>() : otherwise;
}

std::string text_at(const Json& json, std::string_view path, std::string_view otherwise) {
  const Json* value = find(json, path);
  return value && value->is_string() ? value->get<std::string>() : std::string(otherwise);
}

Cell cell(std::string_view text) {
  return {std::string(text)};
}

Cell value_cell(const Json& value, std::string_view unit) {
  return {value_text(value, unit), value.is_number() ? value : Json(nullptr)};
}

Cell share(double fraction) {
  return {percent(fraction), fraction};
}

Html Table::html() const {
  if (rows.empty()) return {};
  std::vector<bool> numbers(columns.size(), false);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (const auto& row : rows) numbers[c] = numbers[c] || (c < row.size() && !row[c].number.is_null());
  const auto number_class = [](bool number) { return number ? markup(" class=\"n\"") : Html(); };
  Html out;
  if (!open)
    out +=
        markup("<details><summary>Table: {} ({})</summary>\n", caption, singular(fmt::format("{} rows", rows.size())));
  out += markup(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table "
      "id=\"table-{}\"><caption>{}</caption>\n"
      "<thead><tr>",
      caption, id, caption);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Column& column = columns[c];
    out += markup("<th scope=\"col\"{}{}>{}{}</th>", number_class(numbers[c]),
                  column.meaning.empty() ? Html() : markup(" title=\"{}\"", column.meaning), column.title,
                  column.unit.empty() ? Html() : markup(" <small>{}</small>", column.unit));
  }
  out += markup("</tr></thead>\n<tbody>\n");
  for (const auto& row : rows) {
    out += markup("<tr>");
    for (std::size_t c = 0; c < row.size(); ++c) {
      const Html number = row[c].number.is_null() ? Html() : markup(" class=\"n\" data-v=\"{}\"", row[c].number.dump());
      out += c == 0 ? markup("<th scope=\"row\"{}>{}</th>", number, row[c].text)
                    : markup("<td{}>{}</td>", number, row[c].text);
    }
    out += markup("</tr>\n");
  }
  out += markup("</tbody></table></div>\n");
  if (!open) out += markup("</details>\n");
  return out;
}

Table table_of(std::string id, std::string caption, const Json& list, const Json& item_schema,
               const std::vector<std::string>& left_out) {
  Table table{std::move(id), std::move(caption)};
  if (list.empty()) return table;
  std::vector<std::string> keys;
  const auto is_among = [](const std::vector<std::string>& these, const std::string& key) {
    return std::find(these.begin(), these.end(), key) != these.end();
  };
  for (const Json& item : list)
    for (const auto& [key, value] : item.items()) {
      if (value.is_structured() || is_among(left_out, key) || is_among(keys, key)) continue;
      const Json* about = find(item_schema, "properties." + key);
      const std::string unit = one_unit(about ? about->value("unit", "") : "", item);
      keys.push_back(key);
      table.columns.push_back(
          {words(key), unit == "fraction" ? "" : unit, about ? about->value("description", "") : ""});
    }
  for (const Json& item : list) {
    auto& row = table.rows.emplace_back();
    for (const std::string& key : keys) {
      const Json* about = find(item_schema, "properties." + key);
      row.push_back(item.contains(key) ? cell(item[key], about ? about->value("unit", "") : "") : cell("–"));
    }
  }
  return table;
}

Table values_of(std::string id, std::string caption, const Json& object, const Json& schema) {
  Table table{std::move(id), std::move(caption), {{"key"}, {"value"}, {"unit"}, {"meaning"}}};
  add_values(table, "", object, schema);
  return table;
}

const Json& schema_at(const Json& schema, std::string_view path) {
  static const Json kNone = Json::object();
  const Json* found = find(schema, path);
  return found ? *found : kNone;
}

int bars_height(const Table& table) {
  return 90 + 30 * static_cast<int>(std::min<std::size_t>(table.rows.size(), 24));
}

Html Figure::html() const {
  return markup(
      "<figure id=\"{}\" data-chart=\"{}\" data-tables=\"{}\"><figcaption>{}{}</figcaption>"
      "<div class=\"plot\" role=\"img\" aria-label=\"{}\" style=\"height:{}px\"></div>{}</figure>\n",
      id, kind, tables, title, note.empty() ? Html() : markup(" <small>{}</small>", note), label, height,
      still.empty() ? Html() : markup("<div class=\"still\">{}</div>", still));
}

}  // namespace carousel::report::html
