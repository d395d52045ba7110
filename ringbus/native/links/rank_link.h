#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <utility>

#include "ringbus/native/links/link.h"

namespace carousel::ringbus {

/// This rank's end of a link from or to a resource of another rank. It holds as many packets as any link: the sender
/// counts the places that it has filled against those that the receiver reports free again, so a full link holds back
/// its sender as a full queue does. A link between two other ranks has no end here and is never used.
class RankLink final : public Link {
 public:
  using Send = std::function<void(std::span<const PacketId>)>;

  /// `send` gives packets to the rank of `to`; empty unless this rank has `from`.
  RankLink(ResourceId from, ResourceId to, std::size_t depth, Send send)
      : Link(from, to), depth_(depth), send_(std::move(send)) {}

  std::size_t free_places() override {
    // Acquire: pairs with credit(). Its packets have left this rank, but the count must not run ahead of them.
    return depth_ - static_cast<std::size_t>(sent_ - taken_.load(std::memory_order_acquire));
  }
  std::size_t capacity() const override { return depth_; }

  // The calls below bring the contents of the other rank's messages. One thread at a time makes them.

  /// At the sender: so many packets have been taken out of the link since the start.
  void credit(std::uint64_t taken) { taken_.store(taken, std::memory_order_release); }
  /// At the receiver: a packet has come, and its contents are in their place.
  void arrive(PacketId id) {
    const std::lock_guard lock(mutex_);
    arrived_.push_back(id);
    any_.store(true, std::memory_order_relaxed);
  }
  /// At the receiver: the count for credit().
  std::uint64_t taken() const { return taken_.load(std::memory_order_acquire); }

 private:
  std::size_t push(std::span<const PacketId> packets) override {
    const std::size_t count = std::min(packets.size(), free_places());
    if (count == 0) return 0;
    send_(packets.first(count));
    sent_ += count;
    return count;
  }
  std::size_t pull(std::span<PacketId> packets) override {
    // Relaxed: only a hint that the lock is worth taking; the mutex publishes the packets.
    if (!any_.load(std::memory_order_relaxed)) return 0;
    const std::lock_guard lock(mutex_);
    const std::size_t count = std::min(packets.size(), arrived_.size());
    for (std::size_t i = 0; i < count; ++i) packets[i] = arrived_[i];
    arrived_.erase(arrived_.begin(), arrived_.begin() + static_cast<std::ptrdiff_t>(count));
    any_.store(!arrived_.empty(), std::memory_order_relaxed);
    taken_.fetch_add(count, std::memory_order_release);
    return count;
  }

  std::size_t depth_;
  Send send_;
  std::uint64_t sent_ = 0;               // by the sender's thread
  std::atomic<std::uint64_t> taken_{0};  // by this rank as the receiver, or reported by the receiver
  std::atomic<bool> any_{false};
  std::mutex mutex_;
  std::deque<PacketId> arrived_;
};

}  // namespace carousel::ringbus
