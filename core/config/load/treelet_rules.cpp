#include <string>

#include <fmt/format.h>

#include "core/config/load/feature_rules.h"

namespace carousel::config {

namespace {

/// Refuses what a machine with collections does at nodes or single shapes, and not at treelets.
void check_collections(const Config& c, const RuleBreach& refuse) {
  constexpr const char* without = ", or bvh.treelets.bytes: 0";
  const auto no = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) refuse(key, message + without);
  };
  const bool bus = is_bus(c.topology), drawn = c.topology.shape == TopologyShape::kGraph;
  no(bus || is_central(c.topology), drawn ? "topology.nodes" : "topology.shape",
     fmt::format(
         "the rays of a treelet are tested one by one and leave it for different places, which {} does not "
         "carry; expected a ring or another network, found {}",
         bus ? "an answer on a bus" : "a central unit",
         drawn ? enum_name(bus ? GraphNodeKind::kBus : GraphNodeKind::kPacketProcess) : enum_name(c.topology.shape)));
  no(c.packets.shapes == PacketShapes::kSingle, "packets.shapes",
     "a visit takes rays through a whole treelet; expected strip, found single");
  no(c.packets.results != PacketResults::kMask, "packets.results",
     fmt::format("rays that leave a treelet are listed in their packet; expected mask, found {}",
                 enum_name(c.packets.results)));
  no(c.bundles.size > 0, "bundles.size",
     fmt::format("single rays go through treelets; expected 0, found {}", c.bundles.size));
  no(c.collections.key == CollectionKey::kBlock, "collections.key",
     "rays gather at treelets; expected node, found block");
  no(c.rays.banks > 0, "rays.banks",
     fmt::format("banks are modelled where the rays of a packet are read for one test; expected 0, found {}",
                 c.rays.banks));
}

}  // namespace

void check_treelets(const Config& c, const RuleBreach& breach) {
  const bool packets = properties_of(c.topology).has_packets;
  if (c.collections.grouped && (c.bvh.treelets.bytes == 0 || !packets))
    breach("collections.grouped",
           "only rays at treelets of the whole tree are grouped; expected false, or bvh.treelets.bytes above 0 and "
           "packets; found true");
  if (c.bvh.treelets.bytes == 0) return;
  if (packets) check_collections(c, breach);
  if (c.bvh.leaves != BvhConfig::Leaves::kTriangles)
    breach("bvh.leaves",
           fmt::format("{0} are not cut into treelets yet; expected triangles, or bvh.treelets.bytes: 0; found {0}",
                       enum_name(c.bvh.leaves)));
  if (c.memory.strip_end == MemoryConfig::StripEnd::kFlag)
    breach("memory.strip_end",
           "the length of a treelet is known; expected length, or bvh.treelets.bytes: 0; found flag");
  if (c.engine.transport != EngineTransport::kLocal)
    breach("engine.transport",
           fmt::format("treelets are not carried over ranks yet; expected local, or bvh.treelets.bytes: 0; found {}",
                       enum_name(c.engine.transport)));
}

}  // namespace carousel::config
