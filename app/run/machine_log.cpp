#include "app/run/machine_log.h"

#include <spdlog/spdlog.h>

#include "accel/traverse/kernels.h"
#include "core/types/enum_names.h"
#include "report/text/number_text.h"
#include "ringbus/protocol/deadlock.h"
#include "ringbus/protocol/flow_rules.h"
#include "ringbus/resource/resource.h"
#include "ringbus/topology/topology.h"

namespace carousel::app {

void log_machine(const Prepared& prepared) {
  const Config& config = prepared.config();
  const EngineConfig& engine = config.engine;
  if (engine.kind == EngineKind::kNative && engine.lanes == Lanes::kRays && engine.simd == SimdTarget::kAuto &&
      !accel::has_lists())
    spdlog::warn("engine.lanes: rays has no effect on this host: lists need avx3, and the best that it has is {}",
                 accel::simd_targets().front());
  if (!spdlog::should_log(spdlog::level::debug)) return;
  const ringbus::Topology topology(config.topology);
  spdlog::debug("machine: {} resources, shape {}, {} links", topology.resources(), enum_name(config.topology.shape),
                topology.wires().size());
  if (topology.has_packets()) {
    const ringbus::FlowRules flow(config.topology.flow, topology.room_for_all());
    const bool stays = config.collections.home == Home::kLocal || topology.resources() == 1;
    spdlog::debug("packets: {}; each resource may have {} under way{}",
                  stays                   ? "they are tested where they are issued"
                  : topology.direct()     ? "they go straight to where their rays are"
                  : topology.routed()     ? "they take the shortest ways"
                  : topology.visits_all() ? "they visit every resource"
                                          : "they pass resources without their rays",
                  topology.packets_in_flight(),
                  topology.directions() > 1 ? fmt::format(" in each of {} directions", topology.directions()) : "");
    const ringbus::DeadlockVerdict& verdict = topology.verdict();
    spdlog::debug("flow: {}, {} free places to inject; deadlock {}: {}", enum_name(config.topology.flow),
                  flow.places_to_inject(), verdict.can_deadlock ? "possible" : "impossible", verdict.rule);
    spdlog::debug("collections: places for {} IDs at each resource, of which {} keep it from blocking",
                  report::grouped(static_cast<std::uint64_t>(config.collections.capacity)),
                  ringbus::minimum_capacity(config, prepared.accel.most_ways(), prepared.accel.levels()));
  }
  spdlog::debug(
      "traversal: {}, where a new ray waits for {} tests; {} levels; kernels for {}",
      topology.has_packets() ? enum_name(config.collections.traversal) : "single rays, depth first",
      ringbus::Resource::initial_tests(ringbus::resource_settings(config, prepared.scene_size()), prepared.accel),
      prepared.accel.max_depth, accel::simd_targets().front());
}

}  // namespace carousel::app
