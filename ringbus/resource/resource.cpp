#include "ringbus/resource/resource.h"

#include <algorithm>
#include <bit>

#include "accel/packed/packed_leaves.h"
#include "ringbus/resource/traversal/make_traversal.h"
#include "ringbus/resource/visit/visit_context.h"

namespace carousel::ringbus {

namespace {

CollectionStore::Settings collection_settings(const ResourceSettings& settings, const accel::Accel& accel,
                                              bool reports_spills) {
  CollectionStore::Settings s;
  s.block_rays = static_cast<std::uint32_t>(block_rays(settings.collections, settings.packets));
  s.packet_rays = static_cast<std::uint32_t>(settings.packets.rays);
  s.ready = static_cast<std::uint32_t>(settings.collections.ready);
  s.capacity_blocks = static_cast<std::uint32_t>(settings.collections.capacity) / s.block_rays;
  s.policy = settings.collections.policy;
  s.select = settings.collections.select;
  s.scene_size = settings.scene_size;
  s.max_depth = accel.max_depth;
  s.reports_spills = reports_spills;
  if (settings.collections.partial == Partial::kAfter)
    s.ripe_after = static_cast<std::uint64_t>(settings.collections.partial_after_cycles);
  return s;
}

TraversalSettings traversal_settings(const ResourceSettings& settings) {
  return {settings.collections.traversal,
          settings.collections.order,
          settings.packets.shapes,
          settings.packets.made_per,
          settings.bundles,
          settings.treelet_triangles,
          settings.scene_size,
          settings.treelets,
          settings.lanes};
}

}  // namespace

Resource::Resource(const ResourceSettings& settings, const accel::Accel& accel, RayStore& store,
                   const ResourceHooks& hooks)
    : events_(hooks.events),
      accel_(accel),
      store_(store),
      root_(hooks.blocks != nullptr ? hooks.blocks->name(accel.root_key()) : accel.root_key()),
      packet_rays_(static_cast<std::size_t>(settings.packets.rays)),
      collections_(collection_settings(settings, accel, hooks.spills_take_time)),
      homes_(settings.collections.home, store.owner(), settings.resources, accel.partition.get()),
      storage_(
          settings.collections, block_rays(settings.collections, settings.packets),
          reserve_blocks(settings.collections, settings.packets, settings.bundles, accel.most_ways(), accel.levels()),
          initial_collections(traversal_settings(settings), accel), collections_),
      completion_(store, hooks.transforms),
      any_hit_(store, hooks.hold_any_hit_rays),
      traversal_(make_traversal(
          traversal_settings(settings),
          {accel, store, completion_, any_hit_, hooks.events != nullptr ? hooks.events->cull_counts() : nullptr,
           hooks.subtree_tracer, hooks.transforms, hooks.blocks})),
      offering_(store, collections_, storage_, homes_, *traversal_,
                settings.resources == 1 || settings.collections.home == Home::kLocal, hooks.events,
                settings.collections.grouped ? packet_rays_ : 0) {}

Resource::~Resource() = default;

std::int32_t Resource::initial_tests(const ResourceSettings& settings, const accel::Accel& accel) {
  return ringbus::initial_tests(traversal_settings(settings), accel);
}

void Resource::admit(std::span<const RayId> rays) {
  const std::int32_t shapes = traversal_->collections_at(root_);
  for (std::size_t i = 0; i < rays.size(); i += packet_rays_)
    for (std::int32_t shape = 0; shape < shapes; ++shape)
      collections_.add(root_, 0, 0.0f, rays.subspan(i, std::min(packet_rays_, rays.size() - i)),
                       static_cast<std::uint8_t>(shape));
  storage_.admit(rays.size());
  record({.kind = EventKind::kAdmit, .resource = id(), .rays = static_cast<std::uint32_t>(rays.size())});
}

TestOutcome Resource::test(Packet& packet) {
  TestOutcome outcome;
  any_hit_.begin();
  local_.gather(packet, store_);
  const auto members = static_cast<std::uint32_t>(local_.size());
  outcome.reads = members;
  if (members > 0) traversal_->test(packet, local_, outcome);
  if (members > 0) outcome.counts.decoded += decoded_blocks(packet, outcome);
  outcome.rays = local_.size();
  outcome.any_hit_slots = any_hit_.slots();
  outcome.any_hit_calls = any_hit_.calls();
  record({.kind = EventKind::kTest,
          .resource = id(),
          .key = packet.key,
          .rays = members,
          .reads = outcome.reads,
          .tested = outcome.rays + (outcome.bundles != nullptr ? outcome.bundles->visit_rays : 0),
          .children = outcome.children,
          .misses = outcome.misses,
          .depth = packet.depth,
          .tests = &outcome.counts,
          .bundles = outcome.bundles,
          .runs = outcome.runs,
          .members = packet.members});
  return outcome;
}

/// Compressed blocks that a visit decodes, once for all of its rays. Those that go through a subtree count their own.
std::uint64_t Resource::decoded_blocks(const Packet& packet, const TestOutcome& outcome) const {
  if (accel_.packed == nullptr || is_treelet(packet.key)) return 0;
  if (outcome.nodes.empty()) return accel::blocks_to_decode(accel_, packet.key.ref);
  std::vector<std::uint32_t> leaves;
  for (const NextNode& node : outcome.nodes) leaves.push_back(node.key.ref.bits());
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  std::uint64_t blocks = 0;
  for (const std::uint32_t leaf : leaves) blocks += accel::blocks_to_decode(accel_, accel::NodeRef::from_bits(leaf));
  return blocks;
}

std::size_t Resource::retire(Packet& packet) {
  const std::size_t joined = join_children(packet, EventKind::kRetire);
  offering_.retire(packet, joined);
  return joined;
}

std::size_t Resource::retire_part(Packet& part) {
  const std::size_t joined = join_children(part, EventKind::kPart);
  offering_.retire_part(part, joined);
  return joined;
}

std::size_t Resource::join_children(Packet& packet, EventKind kind) {
  const std::size_t before = collections_.memberships();
  if (packet.kind == PacketKind::kTest) traversal_->retire(packet, collections_);
  const std::size_t joined = collections_.memberships() - before;
  record({.kind = kind,
          .resource = id(),
          .key = packet.key,
          .rays = static_cast<std::uint32_t>(joined),
          .members = packet.members});
  return joined;
}

void Resource::join(Packet& packet) {
  ids_.clear();
  for (const PacketMember& member : packet.members) ids_.push_back(member.ray);
  collections_.add(packet.key, packet.depth, packet.nearest[0], ids_,
                   static_cast<std::uint8_t>(std::countr_zero(packet.lanes)));
  packet.members.clear();
}

std::uint32_t Resource::discard() {
  collections_.discard();
  completion_.discard();
  traversal_->discard();
  return offering_.discard();
}

}  // namespace carousel::ringbus
