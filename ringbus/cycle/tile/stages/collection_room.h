#pragma once

#include <cstddef>
#include <cstdint>

#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/tile/stages/spill_memory.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus::cycle {

/// A resource's room for collections: whether work waits for it, and the entries that go to memory and come back
/// (`collections.when_full: spill`).
class CollectionRoom {
 public:
  /// Keeps references.
  CollectionRoom(ResourceId id, std::uint64_t block_rays, Resource& resource, ShapeBuffer& shapes)
      : resource_(resource), shapes_(shapes), memory_(id, block_rays) {}

  /// Sends the entries that have been spilled to memory. Nothing waits for that.
  void write_spilled(Cycle now) {
    std::vector<SpillMove>& written = resource_.spills().written;
    for (const SpillMove& move : written) shapes_.port().write(memory_.written(move), now);
    written.clear();
  }
  /// Asks for the entries of the packet last offered that are in memory, for `user`. Returns how many there are.
  std::uint32_t read_spilled(ShapeBuffer::User user, Cycle now) {
    std::vector<SpillMove>& read = resource_.spills().read;
    for (const SpillMove& move : read) shapes_.port().request(memory_.read(move), kSpillTag | user, now);
    const auto count = static_cast<std::uint32_t>(read.size());
    reads_ += count;
    read.clear();
    return count;
  }
  /// One of these reads has been answered.
  void take_answer() { --reads_; }
  std::size_t reads() const { return reads_; }  ///< under way
  const SpillBytes& moved() const { return memory_.moved(); }

  /// New rays or a packet wait for room.
  bool short_of_room() const { return short_; }
  void set_short_of_room(bool is) { short_ = is; }
  /// Forgets what was to be moved.
  void discard() {
    resource_.spills() = {};
    short_ = false;
  }

 private:
  Resource& resource_;
  ShapeBuffer& shapes_;
  SpillMemory memory_;
  std::size_t reads_ = 0;
  bool short_ = false;
};

}  // namespace carousel::ringbus::cycle
