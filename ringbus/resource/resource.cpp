#include "ringbus/resource/resource.h"

#include <algorithm>
#include <utility>

#include "accel/traverse/kernels.h"

namespace carousel::ringbus {

std::uint32_t reserve_blocks(const CollectionsConfig& collections, const BundlesConfig& bundles, int width,
                             int max_depth) {
  // A ray is in one collection at a time, and admission counts a block for each.
  if (collections.traversal == Traversal::kOrdered) return 0;
  const int children = width * static_cast<int>(std::max<std::int64_t>(1, bundles.size));
  return static_cast<std::uint32_t>((children - 1) * (max_depth + 1) + children);
}

namespace {

CollectionStore::Settings collection_settings(const ResourceSettings& config, const accel::Accel& accel) {
  CollectionStore::Settings s;
  s.block_rays = static_cast<std::uint32_t>(config.packets.rays);
  s.ready = static_cast<std::uint32_t>(config.collections.ready);
  s.capacity_blocks = static_cast<std::uint32_t>(config.collections.capacity / config.packets.rays);
  s.policy = config.collections.policy;
  s.select = config.collections.select;
  s.scene_size = config.scene_size;
  s.max_depth = accel.max_depth;
  return s;
}

}  // namespace

Resource::Resource(const ResourceSettings& config, const accel::Accel& accel, RayStore& store,
                   const ResourceHooks& hooks)
    : settings_(config),
      accel_(accel),
      hooks_(hooks),
      culls_(hooks.events != nullptr ? hooks.events->cull_counts() : nullptr),
      ordered_(config.collections.traversal == Traversal::kOrdered),
      single_(config.packets.shapes == PacketShapes::kSingle),
      bounded_(config.collections.when_full == WhenFull::kReserve),
      floor_blocks_(reserve_blocks(config.collections, config.bundles, accel.width, accel.max_depth)),
      store_(store),
      collections_(collection_settings(config, accel)),
      bundled_(config.bundles.size > 0),
      reformed_(config.bundles.lifetime == BundlesConfig::Lifetime::kReformed),
      rebuilds_(reformed_ || config.bundles.split == BundlesConfig::Split::kBuilder),
      split_below_(static_cast<float>(config.bundles.split_below.box_size) * config.scene_size) {
  if (ordered_) stacks_.emplace(store_.slots(), accel.width, accel.max_depth);
  if (bundled_ && rebuilds_) builder_.emplace(config.bundles, config.scene_size);
  free_own_bundles();
}

void Resource::free_own_bundles() {
  free_bundles_.clear();
  const std::uint32_t loaded = store_.slots() + store_.room().loaded;
  for (std::uint32_t bundle = store_.room().own; bundle-- > 0;) free_bundles_.push_back(loaded + bundle);
}

std::uint32_t Resource::discard() {
  collections_.discard();
  issuing_ = {};
  completed_.clear();
  freed_slots_.clear();
  for (std::uint32_t slot = 0; slot < store_.slots(); ++slot) {
    if (ordered_) stacks_->clear(slot);
    if (hooks_.transforms != nullptr) hooks_.transforms->forget(slot);
  }
  free_own_bundles();
  reserved_blocks_ = rays_held_ = 0;
  return std::exchange(in_flight_, 0);
}

bool Resource::is_treelet(const ResourceSettings& config, const accel::Accel& accel, accel::NodeKey key) {
  return config.collections.traversal == Traversal::kTreelet &&
         accel.triangles_below(key) <= static_cast<std::uint64_t>(config.treelet_triangles);
}

std::int32_t Resource::tests_of(const ResourceSettings& config, const accel::Accel& accel, accel::NodeKey key,
                                int strip_size) {
  // An empty scene's root has no shapes, but its packet must come round all the same.
  return config.packets.shapes == PacketShapes::kStrip || is_treelet(config, accel, key) ? 1 : std::max(1, strip_size);
}

std::int32_t Resource::initial_tests(const ResourceSettings& config, const accel::Accel& accel) {
  return tests_of(config, accel, accel.root_key(), accel.strip_size(accel.root_key()));
}

ResourceId Resource::home_of(accel::NodeKey key) const {
  if (settings_.collections.home != Home::kHash) return id();
  const std::uint32_t resources = settings_.resources;
  const ResourceId home(static_cast<std::uint32_t>(((key.bits() * 0x9e3779b97f4a7c15ull) >> 33) % resources));
  return home == excluded_ ? ResourceId((home.value + 1) % resources) : home;
}

// ---- admission

std::size_t Resource::admissible() const {
  constexpr std::size_t kAny = std::size_t{1} << 31;
  if (!bounded_) return kAny;
  const std::int64_t block_rays = settings_.packets.rays;
  const std::int64_t blocks = settings_.collections.capacity / block_rays;
  // Ordered rays may each end up alone in a block. Otherwise only above half free: what new rays put into the
  // root's collection must never crowd out their children.
  if (ordered_) return static_cast<std::size_t>(std::max<std::int64_t>(0, blocks - rays_held_));
  const std::int64_t room =
      collections_.free_blocks() - reserved_blocks_ - std::max<std::int64_t>(floor_blocks_, blocks / 2);
  return room <= 0 ? 0 : static_cast<std::size_t>(room * block_rays);
}

void Resource::admit(std::span<const RayId> rays) {
  const std::size_t block = static_cast<std::size_t>(settings_.packets.rays);
  for (std::size_t i = 0; i < rays.size(); i += block)
    collections_.add(accel_.root_key(), 0, 0.0f, rays.subspan(i, std::min(block, rays.size() - i)));
  rays_held_ += static_cast<std::uint32_t>(rays.size());
  record({.kind = EventKind::kAdmit, .resource = id(), .rays = static_cast<std::uint32_t>(rays.size())});
}

// ---- issuing

std::uint32_t Resource::blocks_needed(accel::NodeKey key, std::uint32_t rays) const {
  if (ordered_) return rays;
  if (!key.ref.is_inner() || is_treelet(key)) return 0;
  if (single_) return 1;
  return accel_.nodes[key.ref.node()].count *
         static_cast<std::uint32_t>(std::max<std::int64_t>(1, settings_.bundles.size));
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
  record({.kind = EventKind::kStall, .resource = id(), .reason = StallReason::kReserve});
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
    const bool one = !single_ || is_treelet(issuing_.key) || home_of(issuing_.key) != id();
    issuing_.shapes = one ? 1 : static_cast<std::uint32_t>(std::max(1, accel_.strip_size(issuing_.key)));
  } else if (in_flight_ > 0 && !fits(blocks_needed(issuing_.key, 0), 0)) {
    return Offer::kStorage;
  }
  fill(packet, issuing_.key, issuing_.depth, issuing_.rays,
       issuing_.shapes == 1 && !single_ ? ~0u : 1u << issuing_.next_shape);
  if (++issuing_.next_shape == issuing_.shapes) issuing_.rays.clear();
  return Offer::kPacket;
}

void Resource::fill(Packet& packet, accel::NodeKey key, std::uint16_t depth, std::span<const RayId> rays,
                    std::uint32_t lanes) {
  packet.home = home_of(key);
  packet.kind = packet.home == id() ? PacketKind::kTest : PacketKind::kMemberships;
  packet.owner = id();
  packet.key = key;
  packet.depth = depth;
  packet.lanes = lanes;
  packet.reserved_blocks =
      packet.kind == PacketKind::kTest ? blocks_needed(key, static_cast<std::uint32_t>(rays.size())) : 0;
  std::fill(std::begin(packet.nearest), std::end(packet.nearest), kInfinity);
  if (packet.kind == PacketKind::kMemberships) packet.nearest[0] = issuing_.entry;
  packet.members.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) packet.members[i] = {rays[i], 0};
  std::fill(packet.owners.begin(), packet.owners.end(), 0);
  // One resource, or collections that stay with their rays: the owner is this one.
  const bool own = settings_.resources == 1 || settings_.collections.home == Home::kLocal;
  for (const RayId ray : own ? rays.first(1) : rays) {
    const std::uint32_t owner = store_.layout().owner(ray).value;
    packet.owners[owner / 64] |= std::uint64_t{1} << (owner % 64);
  }
  if (ordered_) packet.next.assign(rays.size(), NextNode{});
  reserved_blocks_ += packet.reserved_blocks;
  ++in_flight_;
  record({.kind = EventKind::kIssue,
          .resource = id(),
          .key = key,
          .rays = static_cast<std::uint32_t>(rays.size()),
          .members = packet.members});
}

}  // namespace carousel::ringbus
