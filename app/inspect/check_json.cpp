#include "app/inspect/check_json.h"

#include <utility>
#include <vector>

#include "app/host/machine_info.h"
#include "app/run/memory_need.h"
#include "core/config/write.h"
#include "core/system/error.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

/// A message with the place that it is about; what is not known is left out.
Json issue_json(const SourcePosition& position, const std::string& key, const std::string& message) {
  Json out = Json::object();
  if (!position.file.empty()) out["file"] = position.file;
  if (position.line > 0) out["line"] = position.line;
  if (position.column > 0) out["column"] = position.column;
  if (!key.empty()) out["key"] = key;
  out["message"] = message;
  return out;
}

Json scene_json(const scene::Scene& scene) {
  return {{"name", scene.name},
          {"triangles", scene.unique_triangle_count()},
          {"instances", scene.instances.size()},
          {"build_bytes", build_bytes(scene)}};
}

Json memory_json(const MemoryNeed& need) {
  return {{"total_bytes", need.total()},
          {"usable_bytes", usable_memory_bytes()},
          {"parts",
           {{"scene", need.scene},
            {"structure", need.accel},
            {"rays", need.ring.ray_store},
            {"stacks", need.ring.ray_stacks},
            {"collections", need.ring.collections},
            {"packets", need.ring.packets},
            {"waiting_rays", need.ring.rays_waiting},
            {"worker_caches", need.ring.worker_caches},
            {"paths", need.paths},
            {"film", need.film},
            {"hits", need.hits}}}};
}

Json graph_json(const TopologyConfig& topology) {
  const ringbus::GraphFacts facts = ringbus::graph_facts(topology);
  Json out{{"resources", facts.resources}, {"routers", facts.routers}, {"links", facts.links}};
  if (facts.links == 0) return out;
  out["mean_cycles"] = facts.mean_cycles;
  out["longest_cycles"] = facts.longest_cycles;
  out["longest_from"] = facts.longest_from;
  out["longest_to"] = facts.longest_to;
  out["diameter"] = facts.diameter;
  out["busiest"] = facts.busiest;
  out["bound"] = facts.bound;
  if (facts.resources > 1) out["halves_bytes_per_cycle"] = facts.halves.bytes_per_cycle;
  return out;
}

}  // namespace

Json check_json(const std::string& file, const Prepared& p, const ringbus::DeadlockVerdict& verdict, bool strict) {
  Json warnings = Json::array(), ignored = Json::array();
  for (const std::string& warning : p.warnings) warnings.push_back(issue_json({}, "", warning));
  for (const IgnoredKey& key : p.ignored()) ignored.push_back(issue_json(key.position, key.key, std::string(key.why)));
  const bool told = !warnings.empty() || !ignored.empty();
  Json errors = Json::array();
  if (verdict.can_deadlock)
    errors.push_back(issue_json({.file = file}, stuck_key(p.config()),
                                "the links of this machine can fill up and stop, and run refuses it without --force"));
  Json out{{"config", file},
           {"valid", !verdict.can_deadlock && !(strict && told)},
           {"errors", std::move(errors)},
           {"warnings", std::move(warnings)},
           {"ignored_keys", std::move(ignored)},
           {"deadlock", {{"possible", verdict.can_deadlock}, {"rule", verdict.rule}}}};
  if (p.has_rays()) {
    out["scene"] = scene_json(p.scene);
    out["memory"] = memory_json(estimate(p.config(), false, p.scene, p.accel));
  }
  if (p.config().topology.shape == TopologyShape::kGraph) out["graph"] = graph_json(p.config().topology);
  out["resolved"] = config_json(p.absolute_config());
  return out;
}

const char* stuck_key(const Config& config) {
  return config.topology.shape == TopologyShape::kGraph ? "topology.links" : "topology.flow";
}

Json refusal_json(const std::string& file, const std::exception_ptr& error) {
  Json errors = Json::array();
  try {
    std::rethrow_exception(error);
  } catch (const ConfigError& refused) {
    for (const ConfigIssue& issue : refused.issues())
      errors.push_back(issue_json(issue.position, issue.key_path, issue.message));
  } catch (const SceneError& refused) {
    errors.push_back(issue_json({refused.file(), 0, 0}, refused.json_path(), refused.message()));
  } catch (const FileError& refused) {
    errors.push_back(issue_json({}, "", refused.what()));
  }
  return {{"config", file}, {"valid", false}, {"errors", std::move(errors)}};
}

}  // namespace carousel::app
