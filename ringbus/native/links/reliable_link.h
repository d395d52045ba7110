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

/// A link over wires with faults. Frames carry sequence numbers and checksums. The receiver keeps what has come, in any
/// order, until its user takes it in order, and acknowledges both: what it has need not be sent again, and what was
/// taken gives its place back. Users of the link see no packet lost, doubled or out of order.
///
/// Each frame on the wire has a number of its own, and an acknowledgement names the greatest that the receiver has
/// heard. A frame that was sent before that one and is missing is lost. It is sent again alone (selective repeat;
/// Tanenbaum, Computer Networks, "a protocol using selective repeat"; Y. Cheng et al., The RACK-TLP Loss Detection
/// Algorithm for TCP, RFC 8985). After silence the sender sends one frame for an answer.
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
        kept_(depth_),
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
    // The first frame that may be missing; or, if the receiver has all and only lacks time, the last one.
    if (base_ < sent_ && retransmit_.ends(RetransmitTimer::Clock::now)) put_again(known_ < sent_ ? known_ : known_ - 1);
    transmit();
    return moved;
  }
  void tick_receiver() override { answer(take_frames()); }
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
    std::uint64_t sequence = 0, number = 0, packet = 0, check = 0;
    PacketImage* image = nullptr;

    void flip(std::uint64_t bits) {
      const std::size_t word = bits / 64 % (4 + image->size());
      std::uint64_t* const head[] = {&sequence, &number, &packet, &check};
      *(word < 4 ? head[word] : &(*image)[word - 4]) ^= std::uint64_t{1} << bits % 64;
    }
    LinkFrame copy() const { return {sequence, number, packet, check, new PacketImage(*image)}; }
    void drop() { delete std::exchange(image, nullptr); }
  };
  struct Ack {
    std::uint64_t received = 0;  // the first frame that the receiver does not have
    std::uint64_t taken = 0;     // the first that its user has not taken
    std::uint64_t heard = 0;     // the greatest number of a frame that came whole
    std::uint64_t check = 0;
    void flip(std::uint64_t bits) {
      std::uint64_t* const words[] = {&received, &taken, &heard, &check};
      *words[bits / 64 % 4] ^= std::uint64_t{1} << bits % 64;
    }
    Ack copy() const { return *this; }
    void drop() {}
  };
  /// A packet that has not been taken.
  struct Sent {
    PacketId packet;
    PacketImage image;
    std::uint64_t number = 0;  // of its last frame
  };

  /// A checksum. It differs for any two frames that differ within one word, as each step can be undone.
  std::uint64_t check(std::uint64_t sequence, std::uint64_t number, std::uint64_t packet,
                      std::span<const std::uint64_t> image) const {
    std::uint64_t x = number_ * 0x9e3779b97f4a7c15u;
    const auto step = [&x](std::uint64_t word) {
      x = (x ^ word) * 0xbf58476d1ce4e5b9u;
      x ^= x >> 31;
    };
    step(sequence);
    step(number);
    step(packet);
    for (const std::uint64_t word : image) step(word);
    return x;
  }
  std::uint64_t check(const Ack& ack) const { return check(ack.received, ack.taken, ack.heard, {}); }

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
    while (sent_ < next_ && out_.has_room()) {
      retransmit_.sent(sent_);
      put(sent_++);
      schedule_point();
    }
  }
  void put(std::uint64_t sequence) {
    Sent& sent = window_[sequence % depth_];
    sent.number = ++frames_sent_;
    out_.put({sequence, sent.number, sent.packet.value, check(sequence, sent.number, sent.packet.value, sent.image),
              new PacketImage(sent.image)});
  }
  void put_again(std::uint64_t sequence) {
    if (!out_.has_room()) return;  // later, after silence
    ++resent_;
    put(sequence);
  }
  bool take_acks() {
    bool moved = false;
    Ack ack;
    while (acks_.try_pop(ack)) {
      // One from behind is old; one from beyond would be damage that the checksum missed.
      if (ack.check != check(ack) || ack.received < known_ || ack.received > sent_) continue;
      if (ack.received > known_ || ack.taken > base_) {
        known_ = ack.received;
        base_ = std::max(base_, std::min(ack.taken, known_));
        retransmit_.heard(known_);
        moved = true;
      }
      if (known_ < sent_ && window_[known_ % depth_].number < ack.heard) {
        put_again(known_);
        retransmit_.went_back();
      }
    }
    return moved;
  }

  std::size_t pull(std::span<PacketId> packets) override {
    bool news = take_frames();
    std::size_t count = 0;
    for (; count < packets.size() && taken_ < received_; ++taken_)
      packets[count++] = *std::exchange(kept_[taken_ % depth_], std::nullopt);
    news |= count > 0;
    answer(news);
    return count;
  }
  /// Takes all frames off the wire; there is a place for each, as the sender has no more packets that were not taken.
  /// Returns whether there were any.
  bool take_frames() {
    bool any = false;
    LinkFrame frame;
    while (frames_.try_pop(frame)) {
      any = true;
      if (frame.check != check(frame.sequence, frame.number, frame.packet, *frame.image) || !keep(frame)) ++discarded_;
      frame.drop();
      schedule_point();
    }
    while (received_ < taken_ + depth_ && kept_[received_ % depth_]) ++received_;
    return any;
  }
  /// Returns whether the frame, which is whole, is new.
  bool keep(const LinkFrame& frame) {
    heard_ = std::max(heard_, frame.number);
    std::optional<PacketId>& place = kept_[frame.sequence % depth_];
    if (frame.sequence < received_ || place) return false;
    place = PacketId(static_cast<std::uint32_t>(frame.packet));
    if (frame.packet < packets_.size()) restore(*frame.image, packets_[frame.packet]);
    return true;
  }
  /// Sends an acknowledgement after any frame, as an earlier one may have been lost, and when packets were taken.
  void answer(bool news) {
    if (news) {
      Ack ack{received_, taken_, heard_};
      ack.check = check(ack);
      back_.put(ack);
    }
    back_.release();
  }

  std::size_t depth_;
  std::uint64_t number_;
  std::span<Packet> packets_;
  // The sender's state.
  std::vector<Sent> window_;           // by sequence number modulo depth
  std::uint64_t base_ = 0;             // the first frame that may not have been taken
  std::uint64_t known_ = 0;            // the first that the receiver may not have
  std::uint64_t sent_ = 0, next_ = 0;  // the first not sent; not accepted from the user
  std::uint64_t frames_sent_ = 0, resent_ = 0;
  RetransmitTimer retransmit_;
  // The receiver's state.
  alignas(128) std::uint64_t received_ = 0, taken_ = 0, heard_ = 0;  // as in Ack
  std::uint64_t discarded_ = 0;
  std::vector<std::optional<PacketId>> kept_;  // by sequence number modulo depth, until the user takes them
  // The state that both sides share.
  alignas(128) Queue<LinkFrame> frames_;
  SpscRing<Ack> acks_;
  alignas(128) FaultyWire<Queue<LinkFrame>, LinkFrame> out_;  // the sender's end
  alignas(128) FaultyWire<SpscRing<Ack>, Ack> back_;          // the receiver's end
};

}  // namespace carousel::ringbus
