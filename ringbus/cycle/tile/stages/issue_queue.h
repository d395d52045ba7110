#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "ringbus/cycle/shapes/multicast.h"
#include "ringbus/cycle/tile/stages/shade_help.h"
#include "ringbus/cycle/tile/stages/test_contexts.h"

namespace carousel::ringbus::cycle {

/// The start of a packet: from a ready collection to a queue in which it waits for its shapes, until dispatch takes it.
/// A place of the queue is a user of ShapeBuffer, behind those of the contexts.
class IssueQueue {
 public:
  /// A packet in the queue.
  struct Entry {
    PacketId packet;
    ShapeBuffer::User user = 0;
    bool takes_data = false;    ///< it waits for its shapes
    std::uint32_t spilled = 0;  ///< reads of spilled entries that it waits for
  };

  static std::size_t places(const TileSettings& settings) {
    return static_cast<std::size_t>(settings.memory.fetch_ahead) + 1;
  }
  /// Keeps the references.
  IssueQueue(const TileParts& parts, const TileSettings& settings, const TestContexts& contexts, const ShadeHelp& help,
             CollectionRoom& room);

  bool empty() const { return entries_.empty(); }
  bool full() const { return entries_.size() >= places_; }
  std::size_t size() const { return entries_.size(); }
  const Entry& front() const { return entries_.front(); }
  /// Dispatch can take the first packet, as far as its shapes are concerned.
  bool front_is_ready() const {
    if (entries_.empty()) return false;
    const Entry& entry = entries_.front();
    return entry.spilled == 0 && (!entry.takes_data || parts_.shapes.is_here(entry.user));
  }
  Entry take() {
    const Entry entry = entries_.front();
    entries_.pop_front();
    if (entry.takes_data) parts_.shapes.leave_queue(entry.user);
    return entry;
  }

  /// Fills it from collections that may go. `links_rest`: no packet that has arrived waits. Returns whether any packet
  /// has come.
  bool fill(Cycle now, bool links_rest);
  /// Takes in answers to reads of spilled entries.
  void take_spilled();

  /// Collections that are not ready go when the resource has nothing else to do (`collections.partial: idle`).
  bool waits_for_idle() const { return partial_ == Partial::kIdle; }
  /// The time at which a collection that is not ready may go (`collections.partial`); kNever while that waits for
  /// another event.
  Cycle next_partial() const { return next_partial_; }
  /// At the end of a step: a collection may become ready by itself.
  void look_ahead() {
    if (partial_ == Partial::kAfter && !full())
      next_partial_ = std::min(next_partial_, parts_.resource.next_ripe().value_or(kNever));
  }

  /// Its packets come to nothing.
  void discard(Cycle now);

 private:
  bool fetches_ahead(const Packet& packet) const;
  Cycle work_ahead_ends(Cycle now) const;
  Cycle partial_may_go(Cycle now, bool links_rest) const;

  TileParts parts_;
  const TestContexts& contexts_;
  const ShadeHelp& help_;
  CollectionRoom& room_;
  Multicast multicast_;
  Partial partial_;
  Cycle memory_latency_;  // of a miss
  bool fetch_by_resource_;
  bool contexts_fetch_;  // packets travel, and wait in the contexts of others for shapes
  ShapeBuffer::User first_user_;
  std::size_t places_;
  std::deque<Entry> entries_;
  std::size_t issued_ = 0;
  Cycle next_partial_ = kNever;
};

}  // namespace carousel::ringbus::cycle
