#include "report/run/report_page.h"

#include <string_view>

#include <fmt/format.h>

#include "report/run/report_json.h"
#include "report/run/terminal_words.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kHead =
    "# The numbers of a report\n\n"
    "This page is written by `carousel schema report --markdown`. A run prints a table and writes `report.json`, which "
    "has more.\nTwo runs are *identical* when all outside of `host` is equal; where `engine.deterministic` is false, "
    "counts of what threads\nhappened to do may differ between runs. A key that says (native) or (cycle) stands only "
    "in "
    "runs of that engine.\n";
constexpr std::string_view kFirst =
    "\n## The ten numbers to look at first\n\n| key | question |\n|---|---|\n"
    "| `rays.lost` | Did every ray come back? 0, or the run has failed |\n"
    "| `digest.hits` | Is it the answer of another machine? Equal digests are equal hits, to the bit |\n"
    "| `engine.cycles` | How long did the frame take? (cycle) |\n"
    "| `throughput.whole.rays_per_kilocycle` | How fast is the machine? `throughput.steady` is the rate without fill "
    "and drain (cycle) |\n"
    "| `bottleneck` | Which class of parts limits it, and what does doubling that gain? (cycle) |\n"
    "| `bound` | What would the busiest class allow, and how much of that is reached? (cycle) |\n"
    "| `tests.box.per_ray`, `tests.triangle.per_ray` | How much work is a ray? |\n"
    "| `packets.rays_mean` | How full are packets? Small packets waste links and dispatch |\n"
    "| `memory.caches[].hit_fraction`, `memory.dram_utilisation` | Does memory keep up? (cycle) |\n"
    "| `energy.nj_per_ray`, `area.mm2` | What does it cost? With `energy.profile` alone (cycle) |\n";
constexpr std::string_view kTerminalHead =
    "\n## The table of {}\n\n`N` stands for a number, `*` for words.\n\n"
    "| line | text | key in report.json | meaning |\n|---|---|---|---|\n";

/// The schema at a path such as `resources[].units.box.busy`; null if there is none.
const Json* schema_at(const Json& schema, std::string_view path) {
  const Json* at = &schema;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    std::string_view name = path.substr(0, dot);
    path.remove_prefix(std::min(dot + 1, path.size()));
    const bool list = name.ends_with("[]");
    if (list) name.remove_suffix(2);
    const auto properties = at->find("properties");
    if (properties == at->end()) return at->value("type", "") == "object" ? at : nullptr;  // a schema of its own
    const auto found = properties->find(std::string(name));
    if (found == properties->end()) return nullptr;
    at = list ? &(*found)["items"] : &*found;
  }
  return at;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '*') out += '\\';
    out += c;
  }
  return out;
}

void terminal_table(std::string& out, const Json& schema, bool traffic, std::string_view name) {
  out += fmt::format(fmt::runtime(kTerminalHead), name);
  std::string line;
  for (const TerminalWord& word : terminal_words()) {
    if (word.traffic != traffic) continue;
    const Json* at = word.key.empty() ? nullptr : schema_at(schema, word.key);
    const std::string meaning = !word.meaning.empty() ? word.meaning : at ? at->value("description", "") : "";
    out += fmt::format("| {} | {} | {} | {} |\n", word.line == line ? "" : word.line, escaped(word.text),
                       word.key.empty() ? "" : "`" + word.key + "`", escaped(meaning));
    line = word.line;
  }
}

void rows(std::string& out, const std::string& path, const Json& schema) {
  out += fmt::format("| `{}` | {} | {} |\n", path, escaped(schema.value("unit", "")),
                     escaped(schema.value("description", "")));
  const bool list = schema.contains("items") && schema["items"].contains("properties");
  const Json& inside = list ? schema["items"] : schema;
  if (!inside.contains("properties")) return;
  for (const auto& [key, below] : inside["properties"].items()) rows(out, path + (list ? "[]." : ".") + key, below);
}

}  // namespace

std::string report_markdown() {
  const Json schema = report_schema();
  std::string out = fmt::format("{}{}", kHead, kFirst);
  terminal_table(out, schema, false, "a run of rays");
  terminal_table(out, schema, true, "synthetic traffic");
  for (const auto& [key, section] : schema["properties"].items()) {
    out += fmt::format("\n## {}\n\n| key | unit | meaning |\n|---|---|---|\n", key);
    rows(out, key, section);
  }
  return out;
}

}  // namespace carousel::report
