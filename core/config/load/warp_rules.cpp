#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "core/config/load/feature_rules.h"

namespace carousel::config {

namespace {

class WarpRules {
 public:
  WarpRules(const Config& config, const RuleBreach& breach) : c(config), breach_(breach) {}

  void check() {
    if (c.engine.kind != EngineKind::kCycle) return;
    check("testers", c.testers, c.rays.slots_per_resource);
    for_each_own(c.topology, [&](const OwnOf& one) {
      if (one.testers != nullptr)
        check(own_place(one) + ".testers", *one.testers,
              one.keys->slots_per_resource.value_or(c.rays.slots_per_resource));
    });
  }

 private:
  /// `slots`: of the resources with these testers.
  void check(const std::string& testers, const TestersConfig& of, std::int64_t slots) {
    const SimtConfig& simt = of.simt;
    if (simt.warp == 0) return;
    const auto breach = [&](const char* key, std::string message) { breach_(testers + ".simt." + key, message); };
    if (properties_of(c.topology).has_packets)
      breach("warp",
             fmt::format("warps are of resources that trace their own rays, not those of packets; expected 0, "
                         "or topology.shape: independent{}; found {}",
                         c.topology.shape == TopologyShape::kGraph ? ", or topology.trace: stacks" : "", simt.warp));
    if (simt.warp > slots)
      breach("warp", fmt::format("no warp would ever be full; expected at most rays.slots_per_resource = {}, found {}",
                                 slots, simt.warp));
    if (simt.compaction == SimtConfig::Compaction::kRepack && simt.idle_lanes == SimtConfig::IdleLanes::kHelp)
      breach("idle_lanes",
             "no ray of a warp that is packed anew for each step has ended; expected wait, or "
             "compaction: none; found help");
    if (simt.prefetch == SimtConfig::Prefetch::kTreelet && c.bvh.treelets.bytes == 0)
      breach("prefetch",
             "the tree is not cut into treelets; expected none, or bvh.treelets.bytes above 0; found treelet");
    if (of.simd.lanes > 1)
      breach_(
          testers + ".simd.lanes",
          fmt::format("the lanes of a warp share units that test one ray each; expected 1, and more units; found {}",
                      of.simd.lanes));
    if (c.memory.strip_end == MemoryConfig::StripEnd::kFlag)
      breach_("memory.strip_end",
              "the lanes of a warp ask for lines, whose number they have to know; expected length, found flag");
    if (c.shading.idle_resources_shade)
      breach_("shading.idle_resources_shade",
              "resources with warps do not help the shader workers; expected false, found true");
  }

  const Config& c;
  const RuleBreach& breach_;
};

}  // namespace

void check_warps(const Config& config, const RuleBreach& breach) {
  WarpRules(config, breach).check();
}

}  // namespace carousel::config
