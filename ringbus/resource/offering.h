#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ringbus/packets/events.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/resource/homes.h"
#include "ringbus/resource/storage_rule.h"
#include "ringbus/resource/traversal/traversal_method.h"

namespace carousel::ringbus {

/// The answer to a request for a packet.
enum class Offer {
  kNothing,  ///< no collection may go
  kPacket,
  kStorage,  ///< one may go, but its children might not find room until packets in flight have been retired
};

/// Fills packets from a resource's collections. The policy names the collection (collections/issue_policy.h), bounded
/// storage may hold it back (StorageRule), and a block goes out in as many packets as the traversal says, one after
/// another.
class Offering {
 public:
  /// Keeps references. `local` is true if all rays of a packet live at its owner. `events` may be null.
  /// With `group_rays` a packet from a collection that is not ready takes in others of its kind, up to so many rays.
  Offering(const RayStore& rays, CollectionStore& collections, StorageRule& storage, const Homes& homes,
           const TraversalMethod& traversal, bool local, EventSink* events, std::size_t group_rays = 0)
      : rays_(rays),
        collections_(collections),
        storage_(storage),
        homes_(homes),
        traversal_(traversal),
        local_(local),
        events_(events),
        group_rays_(group_rays) {}

  /// Fills `packet` from the next collection: among the ready ones, or with `partial` among all.
  Offer offer(bool partial, Packet& packet);
  /// A packet is back; of its rays, `joined` are in collections again.
  void retire(const Packet& packet, std::size_t joined);
  /// Some of its members are, `part`, before the others.
  void retire_part(const Packet& part, std::size_t joined);

  /// True if a block has gone out in part.
  bool busy() const { return !block_.rays.empty(); }
  /// Packets offered and not yet back.
  std::uint32_t in_flight() const { return in_flight_; }
  /// Forgets them and returns how many there were.
  std::uint32_t discard();

 private:
  /// The block that is going out.
  struct Block {
    std::vector<RayId> rays;
    std::vector<std::uint32_t> joined;  // one a ray
    std::vector<PacketGroup> groups;    // behind those at `key`
    accel::NodeKey key;
    std::uint8_t shape = 0;
    std::uint16_t depth = 0;
    float entry = 0;
    std::uint32_t next_packet = 0, packets = 0;
    std::uint32_t needed = 0;  // blocks that the retirement of a packet may take
  };

  std::optional<CollectionId> choose(bool partial, bool& storage);
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const {
    return homes_.away(key) ? 0 : traversal_.blocks_needed(key, rays);  // they only travel on from here
  }
  void take(CollectionId chosen);
  void group_up();
  void fill(Packet& packet);
  void mark_owners(Packet& packet) const;
  void record(const Event& event) {
    if (events_ != nullptr) [[unlikely]]
      events_->record(event);
  }

  const RayStore& rays_;
  CollectionStore& collections_;
  StorageRule& storage_;
  const Homes& homes_;
  const TraversalMethod& traversal_;
  bool local_;
  EventSink* events_;
  std::size_t group_rays_;
  std::vector<RayId> more_;                 // scratch
  std::vector<std::uint32_t> more_joined_;  // scratch
  Block block_;
  std::uint32_t in_flight_ = 0;
};

}  // namespace carousel::ringbus
