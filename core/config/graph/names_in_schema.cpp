#include "core/config/graph/names_in_schema.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/graph/clocks.h"

namespace carousel::config {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kListed = 64;  // nodes of a group; the pattern takes the others

/// The regular expression of the numbers up to `last`.
std::string numbers_to(std::int64_t last) {
  const std::string digits = std::to_string(last);
  std::vector<std::string> some{digits};
  if (digits.size() > 1) some.push_back(fmt::format("[0-9]{{1,{}}}", digits.size() - 1));
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (digits[i] == '0') continue;
    std::string less = digits.substr(0, i) + fmt::format("[0-{}]", static_cast<char>(digits[i] - 1));
    for (std::size_t after = i + 1; after < digits.size(); ++after) less += "[0-9]";
    some.push_back(std::move(less));
  }
  return fmt::format("{}", fmt::join(some, "|"));
}

/// The nodes that a key may name.
struct KnownNodes {
  std::vector<std::string> listed;   ///< one node each
  std::vector<std::string> groups;   ///< as a whole
  std::vector<std::string> one, of;  ///< regular expressions: of a node, and of nodes of one name
  std::size_t ranges = 0;            ///< of `one`, each with a number that stands there twice

  explicit KnownNodes(const TopologyConfig& config, bool take_packets = false) {
    for (const GraphNode& node : config.nodes) {
      if (take_packets && !takes_packets(node.kind)) continue;
      if (!node.count) {
        for (auto* list : {&listed, &one, &of}) list->push_back(node.name);
        continue;
      }
      const std::string number = numbers_to(*node.count - 1);
      groups.push_back(node.name + "[*]");
      for (std::int64_t i = 0; i < std::min(*node.count, kListed); ++i)
        listed.push_back(fmt::format("{}[{}]", node.name, i));
      // A range of one node has the same number twice, apart from zeros in front.
      const std::string alone = *node.count == 1 ? "\\*|" : "";
      one.push_back(fmt::format("{}\\[(?:{}0*({})(?:\\.\\.0*\\{})?)\\]", node.name, alone, number, ++ranges));
      of.push_back(fmt::format("{0}\\[(?:\\*|0*(?:{1})(?:\\.\\.0*(?:{1}))?)\\]", node.name, number));
    }
  }
};

/// Has a key take these texts, and those of the pattern.
void take_texts(Json& key, const std::vector<std::string>& listed, const std::string& pattern) {
  key.erase("minLength");
  key["anyOf"] = Json::array({Json{{"enum", listed}}, Json{{"pattern", pattern}}});
}

void take_nodes(Json& key, const KnownNodes& nodes) {
  std::vector<std::string> listed = nodes.groups;
  listed.insert(listed.end(), nodes.listed.begin(), nodes.listed.end());
  take_texts(key, listed, fmt::format("^ *(?:{0}) *(?:, *(?:{0}) *)*$", fmt::join(nodes.of, "|")));
}

void take_node(Json& key, const KnownNodes& nodes) {
  take_texts(key, nodes.listed, fmt::format("^ *(?:{}) *$", fmt::join(nodes.one, "|")));
}

void take_clock(Json& key, const ClocksConfig& clocks) {
  key.erase("minLength");
  key["enum"] = ClockTable{clocks}.names();
}

}  // namespace

void name_in_schema(Json& schema, const TopologyConfig& drawn, const ClocksConfig& clocks) {
  const KnownNodes all(drawn), with_packets(drawn, true);
  Json& topology = schema["properties"]["topology"]["properties"];
  const auto items = [&](const char* list) -> Json& { return topology[list]["items"]["properties"]; };
  take_nodes(items("nodes")["serves"], with_packets);
  take_clock(items("nodes")["clock"], clocks);
  for (const char* key : {"from", "to", "all_to", "ring", "line", "of"}) take_nodes(items("links")[key], all);
  take_clock(items("links")["clock"], clocks);
  take_nodes(items("overrides")["nodes"], with_packets);
  take_node(topology["root"], all);
  for (const char* key : {"along", "at"}) take_nodes(items("ways")[key], all);
  take_nodes(items("ways")["to"], with_packets);
  take_node(items("ways")["next"], all);
  for (Json& workload : schema["properties"]["workload"]["anyOf"])
    if (workload.contains("/properties/traffic"_json_pointer))
      for (const char* key : {"sources", "destinations"})
        take_nodes(workload["properties"]["traffic"]["properties"][key], with_packets);
}

}  // namespace carousel::config
