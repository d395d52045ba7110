// The tables of real runs, item by item: each is explained in docs/reference/report, and none is of the other
// engine.
#include <regex>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/terminal_words.h"
#include "report/text/singular.h"
#include "tests/app/support/program.h"

namespace carousel::terminal_table_test {
namespace {

using Json = nlohmann::ordered_json;

/// The noun that may follow a number, with or without a word before it, as a pattern for one of them and for many.
std::string noun_pattern(const std::string& many) {
  const std::string one = report::singular("1 " + many).substr(2);
  return one == many ? many : "(" + many + "|" + one + ")";
}

/// "N rays at *" as a pattern: numbers with their units, words of any length.
std::regex pattern_of(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool alone = (i == 0 || !std::isalpha(static_cast<unsigned char>(text[i - 1]))) &&
                       (i + 1 == text.size() || !std::isalpha(static_cast<unsigned char>(text[i + 1])));
    if (text[i] == 'N' && alone) {
      out += R"([+-]?[0-9][0-9,.]*(e[+-]?[0-9]+)?( min [0-9.]+ s| ?(%|[KMGT]?i?B|ns|us|ms|s|[kMGT]))?)";
      if (i + 1 >= text.size() || text[i + 1] != ' ') continue;
      out += " ?", ++i;  // "1.5 krays/s"
      std::smatch noun;
      const std::string rest = text.substr(i + 1);
      if (!std::regex_search(rest, noun, std::regex("^((inner|more|shader) )?[a-z]+s(?![a-z/_-])"))) continue;
      out += noun_pattern(noun.str());
      i += noun.str().size();
    } else if (text[i] == '*') {
      out += ".*";
    } else if (std::string_view(".()+/[]{}^$|?\\").find(text[i]) != std::string_view::npos) {
      out += std::string("\\") + text[i];
    } else {
      out += text[i];
    }
  }
  return std::regex(out);
}

/// The items of a table: the line's name and the item's text.
std::vector<std::pair<std::string, std::string>> items_of(const std::string& table) {
  std::vector<std::pair<std::string, std::string>> out;
  std::istringstream in(table);
  std::string name;
  for (std::string line; std::getline(in, line);) {
    if (line.size() < 13) continue;
    std::string head = line.substr(0, 13);
    head.erase(head.find_last_not_of(' ') + 1);
    if (!head.empty()) name = head;
    std::string rest = line.substr(13);
    if (name == "resources" || name == "bytes") {
      out.emplace_back(name, std::regex_replace(rest, std::regex(" +"), " "));
      continue;
    }
    rest = std::regex_replace(rest, std::regex(" {3,}"), "\n");
    std::istringstream parts(rest);
    for (std::string part; std::getline(parts, part);) out.emplace_back(name, part);
  }
  return out;
}

class TerminalTable : public testing::Test {
 protected:
  Outcome run(const std::string& config) {
    program_.write("a.yaml", config);
    return program_.run({"run", "a.yaml", "--out", "o", "--force"});
  }

  /// The names of the table's lines.
  std::set<std::string> explained(const std::string& config) {
    const Outcome outcome = run(config);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const bool traffic = config.find("traffic") != std::string::npos;
    std::set<std::string> lines;
    for (const auto& [line, item] : items_of(outcome.out)) {
      lines.insert(line);
      bool found = false;
      for (const report::TerminalWord& word : report::terminal_words())
        found |= word.traffic == traffic && word.line == line && std::regex_match(item, pattern_of(word.text));
      EXPECT_TRUE(found) << line << ": '" << item << "'\n" << outcome.out;
    }
    return lines;
  }

  Program program_;
};

const char* const kSmall =
    "scene: {builtin: instances, instances: 30}\nimage: {width: 12, height: 8, samples: 1}\n"
    "topology: {resources: 2}\n";
const char* const kCycle = "engine: {kind: cycle, what_if: false}\n";

TEST_F(TerminalTable, IsExplainedForBothEngines) {
  const std::set<std::string> native = explained(kSmall);
  EXPECT_TRUE(native.contains("throughput"));
  EXPECT_TRUE(native.contains("stalls"));
  EXPECT_FALSE(native.contains("simulated"));
  const std::set<std::string> cycle = explained(std::string(kSmall) + kCycle);
  EXPECT_FALSE(cycle.contains("throughput"));  // rays a second of the host are no speed of the machine
  EXPECT_FALSE(cycle.contains("stalls"));
  for (const char* line : {"simulated", "busy", "testers wait", "links", "host"})
    EXPECT_TRUE(cycle.contains(line)) << line;
}

TEST_F(TerminalTable, IsExplainedForSpecialParts) {
  const std::string base = std::string(kSmall) + kCycle;
  EXPECT_TRUE(explained(base + "bundles: {size: 8}\n").contains("bundles"));
  EXPECT_TRUE(explained(base + "prefetcher: {lines: 2}\nenergy: {profile: n7}\n").contains("prefetcher"));
  EXPECT_TRUE(explained("scene: {builtin: foliage, triangles: 60}\nimage: {width: 12, height: 8, samples: 1}\n"
                        "topology: {resources: 2}\nbvh: {micromaps: {states: four}}\n" +
                        std::string(kCycle))
                  .contains("micromaps"));
  EXPECT_TRUE(explained(base + "cull_planes: {count: 2}\nprimary: raster\n").contains("cull planes"));
  EXPECT_TRUE(explained(base + "verify: effects\n").contains("all effects"));
  EXPECT_TRUE(explained(base + "verify: reference\nfaults: {links: {drop: 0.05}, compare: true}\n").contains("faults"));
  EXPECT_TRUE(explained(base + "frames: {count: 2}\n").contains("builder"));
  explained(std::string(kSmall) + "engine: {kind: cycle}\nfaults: {resource: {kind: stop, after_rays: 20}}\n");
  EXPECT_TRUE(explained("scene: {builtin: instances, instances: 30}\nimage: {width: 12, height: 8, samples: 1}\n" +
                        std::string(kCycle) + "topology: {shape: central, form: distributor, resources: 1}\n")
                  .contains("distributor"));
}

TEST_F(TerminalTable, IsExplainedForTraffic) {
  explained("engine: {kind: cycle}\nworkload: {traffic: {rate: 0.2, packets: 2000}}\n");
  EXPECT_TRUE(explained("engine: {kind: cycle}\ntopology: {shape: graph, nodes: [{name: r, count: 4}], links: [{ring: "
                        "'r[*]', stops: {rule: slots}}]}\nworkload: {traffic: {rate: 0.2, packets: 2000}}\n")
                  .contains("stops"));
}

// The clock of the host stands below host, and nowhere else.
TEST_F(TerminalTable, CycleRunsHaveNoNativeValuesAndNativeRunsNoTimesOutsideHost) {
  run(kSmall);
  const Json native = Json::parse(program_.read("o/report.json"));
  EXPECT_TRUE(native["resources"][0].contains("stalls"));
  EXPECT_EQ(native["host"]["links"].size(), native["links"].size());
  EXPECT_TRUE(native["host"]["links"][0]["occupancy"].is_array());
  for (const Json& link : native["links"]) EXPECT_FALSE(link.contains("occupancy"));
  EXPECT_FALSE(native["resources"][0].contains("units"));
  run(std::string(kSmall) + kCycle);
  const Json cycle = Json::parse(program_.read("o/report.json"));
  EXPECT_FALSE(cycle["resources"][0].contains("stalls"));
  EXPECT_TRUE(cycle["resources"][0].contains("reserve_entered"));
  EXPECT_FALSE(cycle["host"].contains("links"));
  for (const char* key : {"queue", "sent_at_once", "received_at_once", "full_stalls", "empty_stalls"})
    EXPECT_FALSE(cycle["links"][0].contains(key)) << key;
}

}  // namespace
}  // namespace carousel::terminal_table_test
