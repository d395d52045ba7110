#include "ringbus/verdict/what_if.h"

#include <optional>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/config/differences.h"
#include "core/config/key_conditions.h"
#include "core/config/load/load.h"
#include "core/config/write.h"
#include "core/system/error.h"
#include "ringbus/results/run_features.h"

namespace carousel::ringbus {

namespace {

/// Classes whose sense depends on more than their part: cells are a form of machine, and links that no packet travels
/// still have a width for the wires beside them.
bool makes_sense(const Config& c, std::string_view key) {
  if (key == "testers.simd.lanes") return has_cells(c);
  if (key.starts_with("topology.link.")) return in_use(c, {}, "topology.link.depth");
  return true;
}

/// The classes of parts that the configured machine has with such a scene, as if it were simulated.
std::vector<Relaxation> classes_of(const Config& config, const SceneFacts& scene) {
  Config simulated = config;
  simulated.engine.kind = EngineKind::kCycle;  // a machine that was given for the native engine is simulated here, too
  return relaxations(
      config, [&](const std::string& key) { return in_use(simulated, scene, key) && makes_sense(simulated, key); });
}

/// The configuration as text that is read fast.
std::string text_of(const Config& config) {
  return config_json(config).dump();
}

/// Reads the configuration as a user's who tries the what-if. Returns why it may not be run; absent if it may.
std::optional<std::string> refused_as(const std::string& resolved, const std::vector<std::string>& sets) {
  try {
    load_config({resolved, "what-if.json"}, sets, {.force = true});
    return std::nullopt;
  } catch (const ConfigError& error) {
    const ConfigIssue& first = error.issues().front();
    return first.key_path + ": " + first.message;
  }
}
bool may_be_set(const std::string& resolved, const std::vector<std::string>& sets) {
  return !refused_as(resolved, sets);
}

}  // namespace

Config tester_limited(const Config& config) {
  Config machine = config;
  const bool valid = may_be_set(text_of(config), {});
  for (const Relaxation& part : classes_of(config, {})) {
    for (int i = 0; i < part.how.times; ++i) {
      Config next = machine;
      relax(next, part);
      const std::vector<std::string> sets = config_differences(machine, next);
      if (sets.empty() || (valid && !may_be_set(text_of(machine), sets))) break;
      machine = std::move(next);
    }
  }
  return machine;
}

std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel, std::vector<Untried>* untried) {
  std::vector<WhatIf> all;
  const std::string resolved = text_of(config);
  const bool valid = may_be_set(resolved, {});  // a test's machine may lack keys that what-ifs do not touch
  for (Relaxation& part : classes_of(config, scene_facts(accel))) {
    Config relaxed = config;
    relax(relaxed, part);
    std::vector<std::string> sets = config_differences(config, relaxed);
    if (sets.empty()) continue;
    if (auto why = valid ? refused_as(resolved, sets) : std::nullopt) {
      if (untried != nullptr) untried->push_back({part.part, part.action, std::move(*why)});
      continue;
    }
    all.push_back({std::move(part), std::move(sets), std::move(relaxed)});
  }
  return all;
}

std::optional<Config> relaxed_together(const Config& config, const std::vector<const WhatIf*>& members) {
  Config relaxed = config;
  for (const WhatIf* member : members) relax(relaxed, member->part);
  const std::string resolved = text_of(config);
  if (!may_be_set(resolved, config_differences(config, relaxed)) && may_be_set(resolved, {})) return std::nullopt;
  return relaxed;
}

}  // namespace carousel::ringbus
