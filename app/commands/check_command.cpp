#include "app/commands/check_command.h"

#include <exception>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "app/host/exit_status.h"
#include "app/host/machine_info.h"
#include "app/host/output.h"
#include "app/host/required_modules.h"
#include "app/inspect/check_json.h"
#include "app/run/memory_need.h"
#include "app/trace/memory_csv.h"
#include "core/config/load/load.h"
#include "core/config/write.h"
#include "report/csv/ray_csv.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/protocol/deadlock.h"
#include "ringbus/topology/drawn_shape.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::app {

namespace {

std::string commented(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) out += "# " + line + "\n";
  return out;
}

/// Reads the list, so that its errors are found here as well.
std::string ray_list_text(const Prepared& p) {
  const std::filesystem::path path = find_beside(p.config_folder, p.config().workload.rays_from);
  return fmt::format("rays: {} of {}\n", report::read_rays_csv(path).size(), path.string());
}

using Json = nlohmann::ordered_json;

/// Without the keys that have their defaults.
Json short_form(const Json& item, const Json& defaults) {
  Json out = Json::object();
  for (const auto& [key, value] : item.items())
    if (!defaults.contains(key) || defaults[key] != value) out[key] = value;
  return out;
}

void add_list(std::string& out, const char* key, const Json& items, const Json& defaults) {
  out += fmt::format("  {}:{}\n", key, items.empty() ? " []" : "");
  for (const Json& item : items) out += "    - " + yaml_line(short_form(item, defaults)) + "\n";
}

/// The section `topology` of a network as a graph, whatever its shape: YAML that can stand in its place in a file.
std::string graph_yaml(const TopologyConfig& config, bool traffic) {
  const ringbus::DrawnShape drawn = ringbus::draw_shape(config, traffic);
  Config whole, plain;
  whole.topology = drawn.config;
  plain.topology.nodes.emplace_back();
  plain.topology.links.emplace_back();
  const Json topology = config_json(whole)["topology"], defaults = config_json(plain)["topology"];
  std::string out;
  if (!drawn.same) out += fmt::format("# Not the same machine: {}.\n", drawn.difference);
  out += "topology:\n  shape: graph\n";
  if (!traffic && properties_of(drawn.config).has_packets)
    out += fmt::format("  visit: {}\n", yaml_line(topology["visit"]));
  for (const char* key : {"trace", "form", "flow", "overrides", "routes", "root", "ways", "tour", "channels"})
    if (topology.contains(key) && (!defaults.contains(key) || topology[key] != defaults[key]))
      out += fmt::format("  {}: {}\n", key, yaml_line(topology[key]));
  if (const Json link = short_form(topology["link"], defaults["link"]); !link.empty())
    out += fmt::format("  link: {}\n", yaml_line(link));
  add_list(out, "nodes", topology["nodes"], defaults["nodes"][0]);
  add_list(out, "links", topology["links"], defaults["links"][0]);
  return out;
}

/// The ways of a graph under uniform traffic.
std::string graph_facts_text(const TopologyConfig& config, bool traffic) {
  const ringbus::GraphFacts facts = ringbus::graph_facts(config, traffic);
  std::string out = fmt::format("graph: {} resources, {}, {} links of one way\n", facts.resources,
                                facts.bus.empty() ? fmt::format("{} routers", facts.routers) : "a bus", facts.links);
  out += facts.served;
  if (facts.links == 0) return out;
  out += fmt::format(
      "ways: {:.4f} cycles and {:.4f} nodes on average, {} cycles at most, from {} to {}; {} links at "
      "most\n",
      facts.mean_cycles, facts.mean_nodes, facts.longest_cycles, facts.longest_from, facts.longest_to, facts.diameter);
  out += fmt::format("busiest: {}, on {} of {} ways; a uniform load fills it at {:.4f} flits a resource and cycle\n",
                     facts.busiest, facts.busiest_pairs, facts.ways, facts.bound);
  if (facts.resources > 1)
    out += fmt::format("halves: {} bytes a cycle there and back, {}{}\n", facts.halves.bytes_per_cycle,
                       facts.halves.exact ? "the narrowest of all cuts" : "the narrowest cut that a search found",
                       facts.halves_links.empty() ? ", as no link crosses it" : " (" + facts.halves_links + ")");
  if (facts.wire_mm)
    out += fmt::format("wires: {:.6g} mm of links, {:.6g} bit mm\n", *facts.wire_mm, facts.wire_bit_mm);
  return out;
}

int print_graph(const CheckArguments& arguments) {
  const LocatedConfig located = load_config(read_config_file(arguments.config), arguments.sets, {.force = true});
  const bool traffic = located.config.workload.kind == WorkloadConfig::Kind::kTraffic;
  print_result(graph_yaml(located.config.topology, traffic));
  return kDone;
}

/// The configuration as YAML, and what is known of it as comments.
std::string check_text(const Prepared& p, const ringbus::DeadlockVerdict& verdict) {
  std::string text;
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic) {
    text = "scene: none, synthetic traffic\n";
  } else if (p.config().workload.kind == WorkloadConfig::Kind::kMemoryTrace) {
    const std::filesystem::path path = find_beside(p.config_folder, p.config().workload.memory_trace);
    text = fmt::format("scene: none, {} memory requests of {}\n", read_memory_csv(path).size(), path.string());
  } else {
    text = fmt::format("scene: {}, {} triangles, {} instances\n", p.scene.name, p.scene.unique_triangle_count(),
                       p.scene.instances.size());
    if (p.config().workload.kind == WorkloadConfig::Kind::kRaysFrom) text += ray_list_text(p);
    text += memory_text(estimate(p.config(), false, p.scene, p.accel), usable_memory_bytes());
    text +=
        fmt::format("build: about {} for the structure and the work on it\n", report::bytes_text(build_bytes(p.scene)));
  }
  if (const std::vector<IgnoredKey> ignored = p.ignored(); !ignored.empty())
    text += fmt::format("ignored: {}\n", ignored_text(ignored));
  if (p.config().topology.shape == TopologyShape::kGraph) {
    const bool traffic = p.config().workload.kind == WorkloadConfig::Kind::kTraffic;
    text += report::singular(
        graph_facts_text(p.config().topology, traffic) +
        ringbus::parcel_facts(ringbus::plan_parcels(p.config().topology, p.config().memory.line_bytes)));
  }
  text += fmt::format("deadlock: {}. {}\n", verdict.can_deadlock ? "possible" : "impossible",
                      report::singular(verdict.rule));
  return resolved_yaml(p.absolute_config()) + "\n" + commented(text);
}

/// Prints what the command was asked for. Returns the exit status.
int print_check(const CheckArguments& arguments, const Prepared& p) {
  const ringbus::DeadlockVerdict verdict = ringbus::deadlock_verdict(p.config());
  if (arguments.json)
    print_result(
        check_json(arguments.config, p, verdict, arguments.strict).dump(2, ' ', false, Json::error_handler_t::replace) +
        "\n");
  else
    print_result(check_text(p, verdict));
  int status = kDone;
  if (arguments.strict && !p.warnings.empty()) {
    spdlog::error("{}: {} of the scene's import, which --strict counts as errors", arguments.config,
                  p.warnings.size() == 1 ? "a warning" : fmt::format("{} warnings", p.warnings.size()));
    status = kUsage;
  }
  if (!verdict.can_deadlock) return status;
  spdlog::error("{}: {}: the links of this machine can fill up and stop, and run refuses it without --force",
                arguments.config, stuck_key(p.config()));
  return kUsage;
}

}  // namespace

int check_command(const CheckArguments& arguments) {
  if (arguments.graph) return print_graph(arguments);
  // A topology that can deadlock gets its verdict here instead of a plain refusal.
  std::optional<Prepared> p;
  try {
    p.emplace(prepare(
        arguments, {.force = true, .ranks = true, .frames = true, .searches = true}, false,
        [](const Prepared& of) { require_modules(of.config().engine, of.config().workload, of.config().image); }));
  } catch (...) {
    if (arguments.json)
      print_result(
          refusal_json(arguments.config, std::current_exception()).dump(2, ' ', false, Json::error_handler_t::replace) +
          "\n");
    throw;
  }
  return print_check(arguments, *p);
}

}  // namespace carousel::app
