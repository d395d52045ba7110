#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ringbus/faults/faulty_wire.h"
#include "ringbus/faults/retransmit_timer.h"
#include "ringbus/native/links/link.h"
#include "ringbus/packets/packet_image.h"
#include "ringbus/queues/spsc_ring.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// The parts of the configuration that a reliable link follows.
struct ReliableLinkSettings {
  std::size_t depth = 16;
  FaultsConfig::Links faults;
  std::int64_t seed = 1;
  std::chrono::nanoseconds delay{0};  ///< delay of a frame that is late
};

inline ReliableLinkSettings reliable_link_settings(const LinkConfig& link, const FaultsConfig& faults,
                                                   std::int64_t clock_mhz) {
  return {static_cast<std::size_t>(link.depth), faults.links, faults.seed,
          std::chrono::nanoseconds(faults.links.delay_cycles * 1000 / clock_mhz)};
}

/// A link over wires with faults. Frames carry sequence numbers and checksums, and the receiver takes them in order and
/// acknowledges them. After silence, or when an acknowledgement tells that the first unacknowledged frame is missing,
/// the sender goes back to it (go-back-N; Tanenbaum, Computer Networks, "a protocol using go-back-n"). Users of the
/// link see no packet lost, doubled or out of order; a packet holds its place until it is acknowledged.
///
/// A frame carries a copy of the packet's contents, and the receiver writes the copy over the packet, which nobody else
/// touches between a send and its reception. Any part of a copy may be damaged on the wire. Time passes in turns, ticks
/// of the sender (RetransmitTimer).
template <template <class> class Queue>
class ReliableLink final : public Link {
 public:
  /// Packets that are not among `packets` travel by their ID alone, which serves tests of links without a machine.
  ReliableLink(const ReliableLinkSettings& settings, std::uint64_t number, ResourceId from, ResourceId to,
               std::span<Packet> packets)
      : Link(from, to),
        depth_(settings.depth),
        number_(number),
        packets_(packets),
        window_(depth_),
        frames_(2 * depth_ + 2),
        acks_(kAcks),
        out_(frames_, {settings.faults, settings.seed, 2 * number}, settings.delay),
        back_(acks_, {settings.faults, settings.seed, 2 * number + 1}, settings.delay) {}
  ~ReliableLink() override {
    LinkFrame frame;
    while (frames_.try_pop(frame)) frame.drop();
  }

  std::size_t capacity() const override { return depth_; }
  std::size_t free_places() override {
    (void)take_acks();
    return depth_ - static_cast<std::size_t>(next_ - base_);
  }
  bool tick() override {
    const bool moved = take_acks();
    out_.release();
    if (base_ < sent_ && retransmit_.ends(RetransmitTimer::Clock::now)) go_back();
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
  static constexpr std::size_t kAcks = 64;

  /// Owns its image, but releases it only in drop(), as queues carry trivially copyable values. The thread that took
  /// the frame last drops it.
  struct LinkFrame {
    std::uint64_t sequence = 0, packet = 0, check = 0;
    PacketImage* image = nullptr;

    void flip(std::uint64_t bits) {
      const std::size_t word = bits / 64 % (3 + image->size());
      std::uint64_t* const head[] = {&sequence, &packet, &check};
      *(word < 3 ? head[word] : &(*image)[word - 3]) ^= std::uint64_t{1} << bits % 64;
    }
    LinkFrame copy() const { return {sequence, packet, check, new PacketImage(*image)}; }
    void drop() { delete std::exchange(image, nullptr); }
  };
  struct Ack {
    std::uint64_t expected = 0, check = 0;
    void flip(std::uint64_t bits) { (bits % 2 ? expected : check) ^= std::uint64_t{1} << bits / 2 % 64; }
    Ack copy() const { return *this; }
    void drop() {}
  };
  /// A packet that is not acknowledged.
  struct Sent {
    PacketId packet;
    PacketImage image;
  };

  /// A checksum. It differs for any two frames that differ within one word, as each step can be undone.
  std::uint64_t check(std::uint64_t sequence, std::uint64_t packet, std::span<const std::uint64_t> image) const {
    std::uint64_t x = number_ * 0x9e3779b97f4a7c15u;
    const auto step = [&x](std::uint64_t word) {
      x = (x ^ word) * 0xbf58476d1ce4e5b9u;
      x ^= x >> 31;
    };
    step(sequence);
    step(packet);
    for (const std::uint64_t word : image) step(word);
    return x;
  }
  std::uint64_t check(const Ack& ack) const { return check(ack.expected, ~std::uint64_t{0}, {}); }

  std::size_t push(std::span<const PacketId> packets) override {
    const std::size_t count = std::min(packets.size(), free_places());
    for (std::size_t i = 0; i < count; ++i) {
      const PacketId id = packets[i];
      window_[next_++ % depth_] = {id, id.value < packets_.size() ? image_of(packets_[id.value]) : PacketImage{}};
    }
    transmit();
    return count;
  }
  void transmit() {
    for (; sent_ < next_ && out_.has_room(); ++sent_) {
      const Sent& sent = window_[sent_ % depth_];
      out_.put({sent_, sent.packet.value, check(sent_, sent.packet.value, sent.image), new PacketImage(sent.image)});
      if (sent_ >= once_sent_) {
        once_sent_ = sent_ + 1;
        retransmit_.sent(sent_);
      }
      schedule_point();
    }
  }
  void go_back() {
    resent_ += sent_ - base_;
    sent_ = base_;
  }
  bool take_acks() {
    bool moved = false;
    Ack ack;
    while (acks_.try_pop(ack)) {
      if (ack.check != check(ack)) continue;
      // The receiver has got a frame and still waits for the first unacknowledged one, so that one was lost. It is sent
      // again once for this.
      if (ack.expected == base_ && base_ < sent_ && sent_again_for_ != base_) {
        sent_again_for_ = base_;
        retransmit_.went_back();
        go_back();
      }
      // An acknowledgement from behind is old; one from beyond would be damage that the checksum missed.
      if (ack.expected <= base_ || ack.expected > next_) continue;
      base_ = ack.expected;
      sent_ = std::max(sent_, base_);
      retransmit_.heard(base_);
      moved = true;
    }
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
  /// Takes all frames off the wire. A packet that comes in its turn is offered to `take`, which may refuse it; a packet
  /// that is not taken will come again. After any frame an acknowledgement is sent: an earlier one may have been lost,
  /// and the sender's place is free only when one has come.
  template <class Take>
  void take_frames(const Take& take) {
    bool heard = false;
    LinkFrame frame;
    while (frames_.try_pop(frame)) {
      heard = true;
      const bool whole = frame.check == check(frame.sequence, frame.packet, *frame.image);
      if (whole && frame.sequence == expected_ && take(PacketId(static_cast<std::uint32_t>(frame.packet)))) {
        ++expected_;
        if (frame.packet < packets_.size()) restore(*frame.image, packets_[frame.packet]);
      } else {
        ++discarded_;
      }
      frame.drop();
      schedule_point();
    }
    if (heard) {
      Ack ack{expected_, 0};
      ack.check = check(ack);
      back_.put(ack);
    }
    back_.release();
  }

  std::size_t depth_;
  std::uint64_t number_;
  std::span<Packet> packets_;
  // The sender's state.
  std::vector<Sent> window_;  // by sequence number modulo depth
  std::uint64_t base_ = 0, sent_ = 0,
                next_ = 0;       // the first frame not acknowledged; not sent; not accepted from the user
  std::uint64_t once_sent_ = 0;  // the first frame that has never been on the wire
  RetransmitTimer retransmit_;
  std::uint64_t sent_again_for_ = ~std::uint64_t{0};  // the frame that was last sent again for an acknowledgement
  std::uint64_t resent_ = 0;
  // The receiver's state.
  alignas(128) std::uint64_t expected_ = 0;
  std::uint64_t discarded_ = 0;
  std::optional<PacketId> held_;  // taken off the wire by tick_receiver()
  // The state that both sides share.
  alignas(128) Queue<LinkFrame> frames_;
  SpscRing<Ack> acks_;
  alignas(128) FaultyWire<Queue<LinkFrame>, LinkFrame> out_;  // the sender's end
  alignas(128) FaultyWire<SpscRing<Ack>, Ack> back_;          // the receiver's end
};

}  // namespace carousel::ringbus
