#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/markup/markup.h"

namespace carousel::report::html {

using Json = nlohmann::ordered_json;

/// `memory_latency` as "memory latency".
std::string words(std::string_view key);

/// A sentence with names such as memory_latency in it as words. Keys, which have dots between names, stay.
std::string sentence_words(std::string_view text);

/// With a capital at the start.
std::string capital(std::string text);

/// A value as people read it: groups of digits for counts, percent for the unit `fraction`, yes or no.
std::string value_text(const Json& value, std::string_view unit = "");

/// The value at a path such as `host.machine.cpu`; null if there is none.
const Json* find(const Json& json, std::string_view path);
double number_at(const Json& json, std::string_view path, double otherwise = 0);
std::string text_at(const Json& json, std::string_view path, std::string_view otherwise = "");

/// A cell of a table. `number` is null for a text; the charts read it from the attribute data-v.
struct Cell {
  std::string text;
  Json number = nullptr;
};
Cell cell(std::string_view text);
Cell value_cell(const Json& value, std::string_view unit);
/// Only for Json itself, to which texts would convert.
template <std::same_as<Json> J>
Cell cell(const J& value, std::string_view unit = "") {
  return value_cell(value, unit);
}
Cell share(double fraction);

struct Column {
  std::string title;
  std::string unit{};
  std::string meaning{};
};

/// A table with a caption; its first column names the row.
struct Table {
  std::string id, caption;  ///< the element is table-ID
  std::vector<Column> columns{};
  std::vector<std::vector<Cell>> rows{};

  /// Tables are closed until they are asked for, but for those that are the answer themselves.
  bool open = false;
  /// Nothing if there are no rows.
  Html html() const;
};

/// A table of the numbers and texts of a list of objects, with units and meanings from the schema of an item. Columns
/// of `left_out` and those that hold objects or lists are not shown.
Table table_of(std::string id, std::string caption, const Json& list, const Json& item_schema,
               const std::vector<std::string>& left_out = {});

/// Every value below an object, a row each: key, value, unit, meaning. Lists are left out.
Table values_of(std::string id, std::string caption, const Json& object, const Json& schema);

/// The schema at a path; an empty one if there is none.
const Json& schema_at(const Json& schema, std::string_view path);

/// Pixels for a chart with a bar for each row.
int bars_height(const Table& table);

/// The place of a chart, which the scripts fill when it scrolls into view. `kind` is a name of web/src/charts, `tables`
/// the ids of the tables that it draws, and `label` tells in words, for those who do not see it, its content.
struct Figure {
  std::string id, kind, tables, title, label;
  std::string note{};
  int height = 320;  ///< pixels
  Html still{};      ///< what stands there without scripts
  Html html() const;
};

}  // namespace carousel::report::html
