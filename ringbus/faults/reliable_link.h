#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "ringbus/faults/faulty_wire.h"
#include "ringbus/link.h"
#include "ringbus/queues/spsc_ring.h"

namespace carousel::ringbus {

/// A link over wires that fail: frames carry sequence numbers and checksums, the receiver takes them in order and says
/// how far it is, and after silence the sender goes back to the first that was not acknowledged (go-back-N; Tanenbaum,
/// Computer Networks, "a protocol using go-back-n"). Above it nothing is lost, doubled or out of order; a packet holds
/// its place until it is acknowledged.
///
/// What fails is the frame: the packet's index with number and checksum. The packet's contents stand in memory that
/// both ends share and are not copied.
template <template <class> class Queue>
class ReliableLink final : public Link {
 public:
  ReliableLink(const Config& config, std::uint64_t number, ResourceId from, ResourceId to)
      : Link(from, to), depth_(static_cast<std::size_t>(config.topology.link.depth)), number_(number), window_(depth_),
        frames_(2 * depth_ + 2), acks_(kAcks),
        out_(frames_, config.faults, 2 * number, delay_of(config)),
        back_(acks_, config.faults, 2 * number + 1, delay_of(config)) {}

  std::size_t capacity() const override { return depth_; }
  std::size_t free_places() override {
    (void)take_acks();
    return depth_ - static_cast<std::size_t>(next_ - base_);
  }
  bool tick() override {
    const bool moved = take_acks();
    out_.release();
    // Time is looked at only where something is outstanding.
    if (base_ < sent_ && Clock::now() - heard_ > kPatience) {
      resent_ += sent_ - base_;
      sent_ = base_;
      heard_ = Clock::now();
    }
    transmit();
    return moved;
  }
  void tick_receiver() override {
    take_frames([&](PacketId packet) {
      if (held_) return false;
      held_ = packet;
      return true;
    });
  }
  LinkFaultCounts faults() const override {
    LinkFaultCounts sum = out_.counts();
    sum += back_.counts();
    sum.resent = resent_;
    sum.discarded = discarded_;
    return sum;
  }

 private:
  using Clock = std::chrono::steady_clock;
  // Long against a trip between threads that run, short against a thread that waits for its turn.
  static constexpr std::chrono::microseconds kPatience{300};
  static constexpr std::size_t kAcks = 64;

  struct Frame {
    std::uint64_t sequence = 0, packet = 0, check = 0;
    void flip(std::uint64_t bits) {
      std::uint64_t* const words[] = {&sequence, &packet, &check};
      *words[bits / 64 % 3] ^= std::uint64_t{1} << bits % 64;
    }
  };
  struct Ack {
    std::uint64_t expected = 0, check = 0;
    void flip(std::uint64_t bits) { (bits % 2 ? expected : check) ^= std::uint64_t{1} << bits / 2 % 64; }
  };

  static std::chrono::nanoseconds delay_of(const Config& config) {
    return std::chrono::nanoseconds(config.faults.links.delay_cycles * 1000 / config.engine.clock_mhz);
  }
  /// Differs for any two frames that differ by one bit, as each step can be undone.
  std::uint64_t check(std::uint64_t sequence, std::uint64_t packet) const {
    std::uint64_t x = (sequence + number_ * 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 31)) + packet;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 29);
  }

  std::size_t push(std::span<const PacketId> packets) override {
    const std::size_t count = std::min(packets.size(), free_places());
    if (count > 0 && base_ == next_) heard_ = Clock::now();
    for (std::size_t i = 0; i < count; ++i) window_[next_++ % depth_] = packets[i];
    transmit();
    return count;
  }
  void transmit() {
    for (; sent_ < next_ && out_.has_room(); ++sent_) {
      const std::uint64_t packet = window_[sent_ % depth_].value;
      out_.put({sent_, packet, check(sent_, packet)});
    }
  }
  bool take_acks() {
    bool moved = false;
    Ack ack;
    while (acks_.try_pop(ack)) {
      // One behind is old; one beyond what was sent would be damage that the checksum missed.
      if (ack.check != check(ack.expected, 0) || ack.expected <= base_ || ack.expected > next_) continue;
      base_ = ack.expected;
      sent_ = std::max(sent_, base_);
      moved = true;
    }
    if (moved) heard_ = Clock::now();
    return moved;
  }

  std::size_t pull(std::span<PacketId> packets) override {
    std::size_t count = 0;
    if (!packets.empty() && held_) packets[count++] = *std::exchange(held_, std::nullopt);
    take_frames([&](PacketId packet) {
      if (count == packets.size()) return false;
      packets[count++] = packet;
      return true;
    });
    return count;
  }
  /// Reads the wire dry. What comes in its turn is offered to `take`, which may refuse it; what is not taken will come
  /// again. Whatever came, how far the receiver is goes back: the acknowledgement of something's first coming may have
  /// been lost, and its place at the sender is free only when it knows.
  template <class Take>
  void take_frames(const Take& take) {
    bool heard = false;
    Frame frame;
    while (frames_.try_pop(frame)) {
      heard = true;
      if (frame.check == check(frame.sequence, frame.packet) && frame.sequence == expected_ &&
          take(PacketId(static_cast<std::uint32_t>(frame.packet))))
        ++expected_;
      else
        ++discarded_;
    }
    if (heard) back_.put({expected_, check(expected_, 0)});
    back_.release();
  }

  std::size_t depth_;
  std::uint64_t number_;
  // The sender's.
  std::vector<PacketId> window_;                      // what is not acknowledged, by sequence number modulo depth
  std::uint64_t base_ = 0, sent_ = 0, next_ = 0;      // acknowledged up to; on the wire up to; accepted up to
  Clock::time_point heard_{};                         // when something was last acknowledged, or began to be awaited
  std::uint64_t resent_ = 0;
  // The receiver's.
  alignas(128) std::uint64_t expected_ = 0;
  std::uint64_t discarded_ = 0;
  std::optional<PacketId> held_;   // taken in while nobody wanted it
  // Between them.
  alignas(128) Queue<Frame> frames_;
  SpscRing<Ack> acks_;
  alignas(128) FaultyWire<Queue<Frame>, Frame> out_;   // the sender's end
  alignas(128) FaultyWire<SpscRing<Ack>, Ack> back_;   // the receiver's end
};

}  // namespace carousel::ringbus
