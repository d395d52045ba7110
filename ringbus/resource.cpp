#include "ringbus/resource.h"

#include <algorithm>

#include "accel/kernels.h"
#include "accel/ray_check.h"

namespace carousel::ringbus {

std::uint32_t reserve_blocks(const CollectionsConfig& config, int width, int max_depth) {
  if (config.traversal == Traversal::kOrdered) return 0;   // a ray is in one collection: blocks <= slots
  return static_cast<std::uint32_t>((width - 1) * (max_depth + 1) + width);
}

namespace {

CollectionStore::Settings collection_settings(const Config& config, const accel::Accel& accel, float scene_size) {
  CollectionStore::Settings s;
  s.block_rays = static_cast<std::uint32_t>(config.packets.rays);
  s.ready = static_cast<std::uint32_t>(config.collections.ready);
  s.capacity_blocks = static_cast<std::uint32_t>(config.collections.capacity / config.packets.rays);
  s.policy = config.collections.policy;
  s.select = config.collections.select;
  s.scene_size = scene_size;
  s.max_depth = accel.max_depth;
  return s;
}

}  // namespace

Resource::Resource(ResourceId id, const Config& config, const accel::Accel& accel, float scene_size, EventSink* sink)
    : id_(id),
      config_(config),
      accel_(accel),
      sink_(sink),
      ordered_(config.collections.traversal == Traversal::kOrdered),
      treelets_(config.collections.traversal == Traversal::kTreelet),
      single_(config.packets.shapes == PacketShapes::kSingle),
      bounded_(config.collections.when_full == WhenFull::kReserve),
      floor_blocks_(reserve_blocks(config.collections, accel.width, accel.max_depth)),
      store_(id, static_cast<std::uint32_t>(config.rays.slots_per_resource)),
      collections_(collection_settings(config, accel, scene_size)) {
  if (ordered_) stacks_.emplace(store_.slots(), accel.width, accel.max_depth);
}

bool Resource::is_treelet(accel::NodeKey key) const {
  return treelets_ && accel_.triangles_below(key) <= static_cast<std::uint64_t>(config_.bvh.treelet_triangles);
}

std::int32_t Resource::tests_of(accel::NodeKey key, int strip_size) const {
  return !single_ || is_treelet(key) ? 1 : strip_size;
}

ResourceId Resource::home_of(accel::NodeKey key) const {
  if (config_.collections.home != Home::kHash) return id_;
  return ResourceId(static_cast<std::uint32_t>(((key.bits() * 0x9e3779b97f4a7c15ull) >> 33) %
                                               static_cast<std::uint64_t>(config_.topology.resources)));
}

// ---- admission

std::size_t Resource::admissible() const {
  if (!bounded_ || ordered_) return store_.free_slots();
  // Only above half free: what new rays put into the root's collection must never crowd out their children.
  const std::int64_t room = collections_.free_blocks() - reserved_blocks_ -
                            std::max<std::int64_t>(floor_blocks_, config_.collections.capacity / config_.packets.rays / 2);
  return room <= 0 ? 0 : std::min(store_.free_slots(), static_cast<std::size_t>(room) * static_cast<std::size_t>(config_.packets.rays));
}

void Resource::admit(std::span<const RayRequest> rays) {
  const accel::NodeKey root = accel_.root_key();
  const std::int32_t tests = tests_of(root, accel_.strip_size(root));
  ids_.clear();
  for (const RayRequest& request : rays) {
    const RayId id = store_.allocate();
    const std::uint32_t slot = store_.slot(id);
    accel::start_record(request, store_.record(slot));
    store_.record(slot).pending = tests;
    if (ordered_) stacks_->clear(slot);
    if (tests == 0)
      complete(slot);   // the scene is empty
    else
      ids_.push_back(id);
  }
  const std::size_t block = static_cast<std::size_t>(config_.packets.rays);
  for (std::size_t i = 0; i < ids_.size(); i += block)
    collections_.add(root, 0, 0.0f, std::span(ids_).subspan(i, std::min(block, ids_.size() - i)));
  record({.kind = EventKind::kAdmit, .resource = id_, .rays = static_cast<std::uint32_t>(rays.size())});
}

// ---- issuing

std::uint32_t Resource::blocks_needed(accel::NodeKey key, std::uint32_t rays) const {
  if (ordered_) return rays;
  if (!key.ref.is_inner() || is_treelet(key)) return 0;
  return single_ ? 1 : accel_.nodes[key.ref.node()].count;
}

bool Resource::fits(std::uint32_t needed, std::uint32_t freed) const {
  return !bounded_ || collections_.free_blocks() + freed - reserved_blocks_ - needed >= floor_blocks_;
}

std::optional<CollectionId> Resource::choose(bool partial, bool& storage) {
  const std::optional<CollectionId> best = collections_.best(partial);
  if (!best || fits(blocks_needed(collections_.key(*best), collections_.front_rays(*best)), 1)) return best;
  // One packet at a time, deepest first: each level down needs at most width - 1 blocks more, which the reserve
  // holds, and gives them all back when its subtree is done.
  if (in_flight_ > 0) {
    storage = true;
    return std::nullopt;
  }
  record({.kind = EventKind::kStall, .resource = id_, .reason = StallReason::kReserve});
  return collections_.deepest();
}

Resource::Offer Resource::offer(bool partial, Packet& packet) {
  if (issuing_.rays.empty()) {
    bool storage = false;
    const std::optional<CollectionId> chosen = choose(partial, storage);
    if (!chosen) return storage ? Offer::kStorage : Offer::kNothing;
    issuing_.key = collections_.key(*chosen);
    issuing_.depth = collections_.depth(*chosen);
    issuing_.entry = collections_.entry(*chosen);
    collections_.take(*chosen, issuing_.rays);
    issuing_.next_shape = 0;
    // Memberships that move to another home are not tested here; treelets are tested whole.
    const bool one = !single_ || is_treelet(issuing_.key) || home_of(issuing_.key) != id_;
    issuing_.shapes = one ? 1 : static_cast<std::uint32_t>(accel_.strip_size(issuing_.key));
  } else if (in_flight_ > 0 && !fits(blocks_needed(issuing_.key, 0), 0)) {
    return Offer::kStorage;
  }
  fill(packet, issuing_.key, issuing_.depth, issuing_.rays, issuing_.shapes == 1 && !single_ ? ~0u : 1u << issuing_.next_shape);
  if (++issuing_.next_shape == issuing_.shapes) issuing_.rays.clear();
  return Offer::kPacket;
}

void Resource::fill(Packet& packet, accel::NodeKey key, std::uint16_t depth, std::span<const RayId> rays,
                    std::uint32_t lanes) {
  packet.home = home_of(key);
  packet.kind = packet.home == id_ ? PacketKind::kTest : PacketKind::kMemberships;
  packet.owner = id_;
  packet.key = key;
  packet.depth = depth;
  packet.lanes = lanes;
  packet.reserved_blocks =
      packet.kind == PacketKind::kTest ? blocks_needed(key, static_cast<std::uint32_t>(rays.size())) : 0;
  std::fill(std::begin(packet.nearest), std::end(packet.nearest), kInfinity);
  if (packet.kind == PacketKind::kMemberships) packet.nearest[0] = issuing_.entry;
  packet.members.clear();
  std::fill(packet.owners.begin(), packet.owners.end(), 0);
  for (const RayId ray : rays) {
    packet.members.push_back({ray, 0});
    const std::uint32_t owner = store_.layout().owner(ray).value;
    packet.owners[owner / 64] |= std::uint64_t{1} << (owner % 64);
  }
  if (ordered_) packet.next.assign(rays.size(), NextNode{});
  reserved_blocks_ += packet.reserved_blocks;
  ++in_flight_;
  record({.kind = EventKind::kIssue, .resource = id_, .key = key, .rays = static_cast<std::uint32_t>(rays.size()),
          .members = packet.members});
}

// ---- completion

void Resource::settle(std::uint32_t slot, std::int32_t pending_change) {
  RayRecord& record = store_.record(slot);
  record.pending += pending_change;
  if constexpr (kChecked) {
    if (record.pending < 0)
      throw SimulationError("resource " + std::to_string(id_.value) + " slot " + std::to_string(slot) +
                            ": more answers than pending tests");
  }
  if (record.pending == 0) complete(slot);
}

void Resource::complete(std::uint32_t slot) {
  accel::finish_record(store_.record(slot), completed_);
  store_.free(slot);
}

}  // namespace carousel::ringbus
