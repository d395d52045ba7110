#include "app/charges/charges.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/config/write.h"
#include "core/system/error.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/topology/topology.h"

namespace carousel::app {

namespace {

/// A router of a drawing, or a bridge, for which `fits` holds.
template <class Fits>
bool any_router(const Config& config, const Fits& fits) {
  const ringbus::Topology topology(config.topology);
  for (std::size_t hub = 0; hub < topology.hubs().size(); ++hub) {
    const ResourceId node(static_cast<std::uint32_t>(topology.resources() + hub));
    if (topology.hubs()[hub] == ringbus::TopologyPlan::Hub::kRouter && !topology.ports(node).out.empty() &&
        fits(topology, hub))
      return true;
  }
  return false;
}

bool has_crossbars(const Config& config) {
  return any_router(config, [](const ringbus::Topology&, std::size_t) { return true; });
}

bool has_routers_with_room_for_all(const Config& config) {
  return any_router(config,
                    [](const ringbus::Topology& topology, std::size_t hub) { return topology.hub_places(hub) == 0; });
}

bool has_messages_on_links(const Config& config) {
  return ringbus::plan_parcels(config.topology, config.memory.line_bytes).any();
}

constexpr std::array kCharges{
    Charge{"sorted_ids", "IDs of rays that hit are sorted by child and appended to collections in no time",
           "collections.sort_ids_per_cycle", "0", "8"},
    Charge{"ray_reads", "testers read any number of ray records in a cycle", "rays.reads_per_cycle", "0", "1"},
    Charge{"l2_answers", "a shared cache answers with any number of bytes in a cycle",
           "memory.l2_answer_bytes_per_cycle", "0", "16"},
    Charge{"l2_misses", "a shared cache keeps track of any number of lines on their way", "memory.l2_mshrs", "0", "64"},
    Charge{"l1_misses", "a resource's own cache keeps track of any number of lines on their way", "memory.l1_mshrs",
           "0", "8"},
    Charge{"path_state", "the states of paths are where shading needs them", "memory.path_state", "free", "memory"},
    Charge{"film", "light is added to the picture for nothing", "memory.film", "free", "memory"},
    Charge{"sky_map", "texels and tables of the sky's map are where shading needs them", "memory.sky_map", "free",
           "memory"},
    Charge{"surfaces", "materials, vertices and texels are where shading needs them", "memory.surfaces", "free",
           "memory"},
    Charge{"ray_records", "rays have no master copies in memory", "memory.ray_records", "resource", "master"},
    Charge{"products", "products of surfaces' effects take no time", "shading.products_per_cycle", "0", "8"},
    Charge{"lookups", "texture lookups take no time", "shading.cycles_per_lookup", "0", "5"},
    Charge{"stack_room", "stacks of rays have room for all of their entries", "testers.stack_entries", "0", "8"},
    Charge{"translation", "addresses of the memory are physical", "memory.translation.page_bytes", "0", "2097152"},
    Charge{"instructions", "the instructions of all programs are at hand in each shader worker",
           "shading.instruction_cache.bytes", "0", "4096"},
    Charge{"program_pages", "addresses of the data that shader programs read are physical",
           "shading.translation.page_bytes", "0", "2097152"},
    Charge{"raster", "first hits are rasterised in no time, and are where shading needs them", "raster.time", "free",
           "cycles"},
    Charge{"stack", "choosing a ray and moving entries of its stack take no cycles", "", "", "",
           "topology.shape=independent topology.trace=stacks"},
    Charge{"waiting_hits", "nodes and hits that wait for a later round are moved in no time, and always find room", "",
           "", "", "rays.query.rounds=resume"},
    Charge{"quantised_nodes", "decoding quantised nodes takes no cycles", "", "", "",
           "bvh.storage=quantised bvh.storage=quantised_12"},
    Charge{"shape_reads", "shapes that lie in a resource's buffer are read in no time", "", "", "",
           "memory.shape_buffer_kib"},
    Charge{"ray_writes", "results are written to ray records without a port", "", "", "", "rays.reads_per_cycle"},
    Charge{"sorted_vectors", "completed rays are sorted by shader without bytes that move", "", "", "",
           "shading.sort_rays_per_cycle"},
    Charge{"loaded_programs", "programs are in their stores from the start", "", "", "", "programs.simple_cycles"},
    Charge{"moved_vertices", "vertices are moved, and a rebuild sorts primitives along three axes, in no time", "", "",
           "", "frames.builder"},
    Charge{"crossbars", "the crossbars of routers have no area", "", "", "", "", has_crossbars},
    Charge{"router_room", "routers have room for all packets there are, without area (topology.nodes: buffers)", "", "",
           "", "", has_routers_with_room_for_all},
    Charge{"message_room", "nodes have room for all that links carry beside packets, without area", "", "", "", "",
           has_messages_on_links},
};

/// The value of a key as `--set` takes it; empty if the configuration has none.
std::string value_of(const nlohmann::ordered_json& config, std::string_view key) {
  const nlohmann::ordered_json* at = &config;
  while (!key.empty()) {
    const std::size_t dot = std::min(key.find('.'), key.size());
    const auto found = at->find(std::string(key.substr(0, dot)));
    if (found == at->end()) return "";
    at = &*found;
    key.remove_prefix(std::min(dot + 1, key.size()));
  }
  return at->is_string() ? at->get<std::string>() : at->dump();
}

/// `settings`: with spaces between them; a key alone is one of any value.
bool has_one_of(const LocatedConfig& located, const nlohmann::ordered_json& json, const SceneFacts& scene,
                std::string_view settings) {
  while (!settings.empty()) {
    const std::size_t end = std::min(settings.find(' '), settings.size());
    const std::string_view setting = settings.substr(0, end), key = setting.substr(0, setting.find('='));
    const bool set = key == setting || value_of(json, key) == setting.substr(key.size() + 1);
    if (set && in_use(located.config, scene, key)) return true;
    settings.remove_prefix(std::min(end + 1, settings.size()));
  }
  return false;
}

bool makes_use(const Charge& charge, const LocatedConfig& located, const nlohmann::ordered_json& json,
               const SceneFacts& scene) {
  const std::string_view key = charge.key;
  if (charge.has != nullptr) return charge.has(located.config);
  if (key.empty()) return has_one_of(located, json, scene, charge.where);
  return value_of(json, key) == charge.free && in_use(located.config, scene, key);
}

}  // namespace

std::span<const Charge> all_charges() {
  return kCharges;
}

std::vector<const Charge*> uncharged(const LocatedConfig& located, const SceneFacts& scene) {
  const nlohmann::ordered_json json = config_json(located.config);
  std::vector<const Charge*> out;
  for (const Charge& charge : kCharges)
    if (makes_use(charge, located, json, scene)) out.push_back(&charge);
  return out;
}

LocatedConfig load_charged(const ConfigText& text, const std::vector<std::string>& sets,
                           const ValidateOptions& options) {
  LocatedConfig out = load_config(text, sets, options);
  std::vector<std::string> charged;
  SceneFacts scene;
  scene.gaussians = out.config.scene.builtin == BuiltinScene::kGaussians;  // those of a file are not known yet
  for (const Charge* charge : uncharged(out, scene)) {
    if (*charge->key == 0) continue;
    std::vector<std::string> more = charged;
    more.push_back(std::string(charge->key) + "=" + charge->charged);
    std::vector<std::string> all = more;
    all.insert(all.end(), sets.begin(), sets.end());
    try {
      out = load_config(text, all, options);
      charged = std::move(more);
    } catch (const ConfigError&) {  // the machine cannot have it, and the run lists it as free
    }
  }
  return out;
}

}  // namespace carousel::app
