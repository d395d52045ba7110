#include "core/config/load/ignored_keys.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/differences.h"
#include "core/config/graph/routes.h"
#include "core/config/machine_conditions.h"
#include "core/config/write.h"
#include "core/system/error.h"
#include "core/types/added_names.h"

namespace carousel {

namespace {

/// Calls `visit` with the path of each value that is no section.
void walk(const nlohmann::ordered_json& value, const std::string& path,
          const std::function<void(const std::string&)>& visit) {
  if (!value.is_object() || value.empty()) return visit(path);
  for (const auto& [name, below] : value.items()) walk(below, path.empty() ? name : path + "." + name, visit);
}

/// True if the configuration gives each key that a resolved one has.
bool gives_all(const Config& config, const std::vector<std::string>& given) {
  bool all = true;
  walk(config_json(config), "", [&](const std::string& key) {
    const auto is_given = [&](const std::string& one) { return one == key || key.starts_with(one + "."); };
    all = all && (key == "vary" || std::any_of(given.begin(), given.end(), is_given));
  });
  return all;
}

/// The numbers that resources have of their own, where the machine would not feel the key of all of them.
void add_own(const LocatedConfig& located, const SceneFacts& scene, std::vector<IgnoredKey>& out) {
  const Config& c = located.config;
  for_each_own(c.topology, [&](const OwnOf& one) {
    const std::string place = own_place(one);
    if (unused_because(c, scene, place)) return;                      // the entry is named as a whole
    const auto all = unused_because(c, scene, "topology.overrides");  // for nodes as well
    const auto add = [&](std::string_view name, std::optional<std::string_view> why) {
      const std::string key = fmt::format("{}.{}", place, name);
      if (why) out.push_back({key, *why, located.positions.find(key)});
    };
    if (one.testers != nullptr && *one.testers != c.testers) add("testers", all);
    config::for_each_own_key([&](const auto& row) {
      if (one.keys->*row.own) add(row.name, all ? all : unused_because(c, scene, row.path));
    });
  });
}

/// The keys of drawn nodes and links, and the clocks that these name, that the machine cannot feel.
void add_drawn(const LocatedConfig& located, const SceneFacts& scene, std::vector<IgnoredKey>& out) {
  const Config& c = located.config;
  const TopologyConfig& t = c.topology;
  if (t.shape != TopologyShape::kGraph || unused_because(c, scene, "topology.nodes")) return;
  const auto add = [&](bool given, std::string_view why, std::string key) {
    if (given) out.push_back({key, why, located.positions.find(key)});
  };
  const bool native = c.engine.kind == EngineKind::kNative, choose = !native || config::latencies_choose_ways(t),
             silent = drawn_pools(t).silent > 0;
  const std::string_view no_clock = conditions::kCycle.otherwise,
                         one_pool = "the native engine has one pool of all shader workers";
  for (std::size_t i = 0; i < t.nodes.size(); ++i) {
    const GraphNode& node = t.nodes[i];
    const auto of = [&](const char* key) { return fmt::format("topology.nodes.{}.{}", i, key); };
    add(node.claim_cycles > 0 && c.workload.kind != WorkloadConfig::Kind::kTraffic, conditions::kChannels.otherwise,
        of("claim_cycles"));
    if (!native) continue;
    add(node.latency_cycles > 0 && !(choose && t.tour == Tour::kNearest), no_clock, of("latency_cycles"));
    add(node.credit_cycles > 0, no_clock, of("credit_cycles"));
    add(node.forward != Forward::kHead, no_clock, of("forward"));
    add(!node.clock.empty(), no_clock, of("clock"));
    if (node.kind != GraphNodeKind::kShading) continue;
    add(!node.serves.empty(), one_pool, of("serves"));
    add(node.workers && silent, one_pool, of("workers"));  // else they are all workers
  }
  for (std::size_t i = 0; i < t.links.size() && native; ++i) {
    const GraphLink& link = t.links[i];
    const auto of = [&](const char* key) { return fmt::format("topology.links.{}.{}", i, key); };
    const bool packets = std::ranges::count(link.carries, Carried::kPackets) > 0;
    add(link.latency_cycles && !(packets && choose), no_clock, of("latency_cycles"));
    add(link.bytes_per_cycle && !is_added(t.routes), no_clock, of("bytes_per_cycle"));  // a plugin is told it
    add(!link.clock.empty(), no_clock, of("clock"));
  }
  for (const auto& [name, mhz] : c.clocks.others) add(native, no_clock, "clocks." + name);
}

bool is_set_by_option(const SourcePosition& position) {
  return position.file.starts_with("--set ");
}

}  // namespace

std::vector<IgnoredKey> ignored_keys(const LocatedConfig& located, const SceneFacts& scene) {
  const std::vector<std::string> given = located.positions.given();
  std::vector<std::string> differing;
  const bool resolved = gives_all(located.config, given);
  if (resolved)
    for (const std::string& set : config_differences(Config{}, located.config))
      differing.push_back(set.substr(0, set.find('=')));
  std::vector<IgnoredKey> out;
  for (const std::string& key : given) {
    const auto why = unused_because(located.config, scene, key);
    if (!why) continue;
    const SourcePosition position = located.positions.find(key);
    const bool differs = std::find(differing.begin(), differing.end(), key) != differing.end();
    if (!resolved || differs || is_set_by_option(position)) out.push_back({key, *why, position});
  }
  add_own(located, scene, out);
  add_drawn(located, scene, out);
  std::ranges::sort(out, {}, &IgnoredKey::key);
  return out;
}

std::string ignored_text(std::span<const IgnoredKey> keys) {
  std::vector<std::pair<std::string_view, std::vector<std::string_view>>> by_reason;
  for (const IgnoredKey& key : keys) {
    const auto known =
        std::find_if(by_reason.begin(), by_reason.end(), [&](const auto& reason) { return reason.first == key.why; });
    (known == by_reason.end() ? by_reason.emplace_back(key.why, std::vector<std::string_view>{}) : *known)
        .second.push_back(key.key);
  }
  std::string out;
  for (const auto& [why, names] : by_reason)
    out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", fmt::join(names, ", "), why);
  return out;
}

void refuse_ignored(std::span<const IgnoredKey> keys) {
  std::vector<ConfigIssue> issues;
  for (const IgnoredKey& key : keys)
    issues.push_back({key.position, key.key,
                      fmt::format("the machine cannot feel this key, since {}; expected a configuration without it, or "
                                  "a run without --strict",
                                  key.why)});
  if (!issues.empty()) throw ConfigError(std::move(issues));
}

}  // namespace carousel
