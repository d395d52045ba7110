#include <fmt/format.h>

#include "core/config/write.h"
#include "report/html/html.h"
#include "report/html/packed_series.h"
#include "report/html/run_sections.h"

namespace carousel::report::html {

namespace {

void add_differences(Table& table, const std::string& path, const Json& config, const Json* defaults) {
  for (const auto& [key, value] : config.items()) {
    const std::string name = path.empty() ? key : path + "." + key;
    const Json* other = defaults && defaults->is_object() ? find(*defaults, key) : nullptr;
    if (other && *other == value) continue;
    if (value.is_object())
      add_differences(table, name, value, other);
    else
      table.rows.push_back({cell(name), cell(value.is_string() ? value.get<std::string>() : value.dump()),
                            cell(other ? other->is_string() ? other->get<std::string>() : other->dump() : "–")});
  }
}

}  // namespace

Html charges_section(const Json& report) {
  const Json *charges = find(report, "charges"), *ignored = find(report, "ignored_keys");
  Html out;
  if (charges && !charges->empty()) {
    Table table{"charges-table", "What costs nothing in this run", {{"what"}, {"meaning"}, {"key"}, {"charged by"}}};
    for (const Json& charge : *charges) {
      const std::string key = text_at(charge, "key"), set = text_at(charge, "set");
      table.rows.push_back({cell(words(text_at(charge, "name"))), cell(text_at(charge, "meaning")),
                            cell(key.empty() ? "none" : key), cell(set.empty() ? "–" : "--set " + set)});
    }
    out += markup(
               "<p>Some work of this machine costs no cycles. <code>--charge-all</code> charges all that has a "
               "key.</p>\n") +
           table.html();
  }
  if (ignored && !ignored->empty()) {
    Table table{"ignored-table", "Keys that are set and have no effect in this run", {{"key"}}};
    for (const Json& key : *ignored)
      table.rows.push_back({cell(key.is_string() ? key.get<std::string>() : key.dump())});
    out += table.html();
  }
  return out;
}

Html configuration_section(const Json& report) {
  const Json* config = find(report, "config");
  if (!config || config->empty()) return {};
  const Json defaults = config_json(Config{});
  Table table{"config-table", "Keys that differ from their defaults", {{"key"}, {"value"}, {"default"}}};
  add_differences(table, "", *config, &defaults);
  Html out = table.rows.empty() ? markup("<p>All keys have their defaults.</p>\n") : table.html();
  const std::string json = config->dump(2);
  out += markup(
      "<p><a download=\"config.resolved.json\" href=\"data:application/json;base64,{}\">Save the resolved configuration"
      "</a>, which <code>carousel run</code> reads.</p>\n<details><summary>The whole resolved "
      "configuration</summary><pre tabindex=\"0\"><code>{}</code></pre></details>\n",
      base64(json), json);
  return out;
}

}  // namespace carousel::report::html
