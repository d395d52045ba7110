#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <type_traits>
#include <utility>

#include "ringbus/cycle/fabric/link_recorder.h"
#include "ringbus/cycle/fabric/token.h"
#include "ringbus/faults/link_fault_timer.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/time/channel.h"
#include "ringbus/time/fifo.h"

namespace carousel::ringbus::cycle {

/// A link between two nodes: packets go one way, credits the other, which say that a place in the receiver's input
/// queue has become free. A packet is a T that knows how many cycles it occupies a link, T::link_cycles: a Token, or
/// synthetic traffic.
template <class T>
struct WireOf {
  explicit WireOf(const ChannelPlace& place) : packets(place) {}

  Channel<T, true> packets;
  alignas(64) Occupancy queue;  ///< the receiver's
};

/// The receiver of a link goes by another clock than the link.
struct FarClock {
  ClockRatio to_link;
  Cycle credit_cycles = 0;  ///< by its own clock, before a credit leaves

  /// When the link takes over the credit of a packet that is taken `now`. Out of line, as few links have a clock of
  /// their own.
  [[gnu::cold, gnu::noinline]] Cycle leaves(Cycle now) const { return to_link.enter(now + credit_cycles); }
};

/// The sender of a link goes by another clock than the link, which moves packets by its own: what the sender hands over
/// passes a synchroniser, in which the next packet may be while the link still moves one.
struct NearClock {
  ClockRatio to_link;
  Cycle node_cycles = 0;                            ///< by the sender's clock, before the link
  Cycle link_free = 0;                              ///< by the link's
  Cycle busy = 0;                                   ///< likewise
  std::deque<std::pair<Cycle, Cycle>> stretches{};  ///< begin and end of each in which it moves something, likewise

  /// It moves something for so many cycles until `end`. Earlier times than `now`, by the sender's clock, are not asked
  /// for again.
  void moves(Cycle now, Cycle end, Cycle cycles) {
    link_free = end;
    busy += cycles;
    const Cycle past = to_link.floor_to_network(now);
    while (!stretches.empty() && stretches.front().second <= past) stretches.pop_front();
    if (!stretches.empty() && stretches.back().second == end - cycles)
      stretches.back().second = end;
    else
      stretches.emplace_back(end - cycles, end);
  }
  /// The cycles before `edge` in which it moved something.
  Cycle moved(Cycle edge) const {
    Cycle later = 0;
    for (const auto& [begin, end] : stretches) later += end - std::min(end, std::max(begin, edge));
    return busy - later;
  }

  /// The first cycle of the sender in which a packet may leave that the link begins to move at `edge` at the earliest.
  Cycle leaves_for(Cycle edge) const { return to_link.first_for(edge, node_cycles); }
};

/// The port by which packets come in: the far end of a link, with the queue of `topology.link.depth` places at it. A
/// place is held until the packet is taken; the credit needs the link's latency to get back.
template <class T>
struct InPortOf {
  WireOf<T>* wire = nullptr;
  Cycle latency = 1;
  std::shared_ptr<const FarClock> clock{};  ///< of a link by another clock, whose cycles the latency then is

  Cycle next() const { return wire->packets.next(); }
  const T& front() const { return wire->packets.front(); }
  /// With a choice among the packets that have arrived (`testers.window`).
  Cycle next_after(Cycle now) const { return wire->packets.next_after(now); }
  std::size_t arrived(Cycle now) const { return wire->packets.arrived(now); }
  const T& peek(std::size_t place) const { return wire->packets.peek(place); }
  void bring_forward(std::size_t place) { wire->packets.bring_forward(place); }

  /// Inlined, as OutPortOf::launch().
  [[gnu::always_inline]] T take(Cycle now) {
    if (const Cycle arrival = wire->packets.next(); arrival < now) note_wait(arrival, now);
    return wire->packets.take((clock == nullptr ? now : clock->leaves(now)) + latency);
  }

 private:
  void note_wait(Cycle arrival, Cycle now) {
    Occupancy& queue = wire->queue;
    queue.packet_cycles += now - arrival;
    // The packet that leaves now was there until now. The queue is never longer than just before a packet leaves it.
    if (wire->packets.size() > queue.most)
      queue.most = std::max<std::uint64_t>(queue.most, wire->packets.arrived(now - 1));
  }
};

/// The port by which packets leave: an egress queue, and the near end of a link. A packet occupies the link for as many
/// cycles as it has widths; its head arrives `latency` cycles after it started, its tail accordingly later.
template <class T>
class OutPortOf {
 public:
  OutPortOf(WireOf<T>& wire, Cycle latency, std::uint32_t depth, std::size_t places)
      : wire_(&wire), latency_(latency), credits_(depth), places_(places) {}
  /// From now on the link has faults, whose times are by the clock of the link.
  void fail(const LinkFaultTimer& faults) {
    faults_ = std::make_unique<LinkFaultTimer>(faults);
    plain_ = false;
  }
  /// The link goes by another clock than its sender; its latency is by its own.
  void cross(const ClockRatio& to_link, Cycle node_cycles) {
    near_ = std::make_unique<NearClock>(NearClock{to_link, node_cycles});
    plain_ = false;
  }
  /// From now on the packets that it sends are noted.
  void record(const LinkRecorder& recorder) { recorder_ = recorder; }

  bool has_place() const { return queue_.size() + reserved_ < places_; }
  void reserve() { ++reserved_; }
  void release() { --reserved_; }
  /// Puts a packet into the egress queue. It is not sent before `ready`. `cut_through`: the receiver passes it on
  /// without waiting for the tail.
  void push(const T& token, Cycle ready, bool cut_through) { queue_.push_back({token, ready, cut_through}); }

  /// The link has moved a packet for so many cycles before it was pushed, as the port of a ring does, flit by flit.
  void count_moved(Cycle cycles) { busy_ += cycles; }

  void take_credits(Cycle now) {
    if (faults_) [[unlikely]]
      return take_uncertain_credits(now);
    credits_ += wire_->packets.take_returns(now);
  }
  /// Sends one packet if it may. Returns whether it did.
  bool send(Cycle now) {
    if (credits_ == 0 || queue_.empty()) return false;
    const Cycle wanted = wants_to_start();
    if (wanted > now) return false;
    stalled_ += now - wanted;  // it would have gone at once if there had been a credit
    start(queue_.front().token, now, queue_.front().cut_through);
    queue_.pop_front();
    return true;
  }
  /// Free places of the receiver's queue that no packet in the egress queue will take.
  std::int64_t spare_places() const {
    return static_cast<std::int64_t>(credits_) - static_cast<std::int64_t>(queue_.size() + reserved_);
  }
  /// Tells whether launch() may send a packet that leaves the receiver `places` - 1 free places; not while packets wait
  /// in the egress queue. Takes credits when it needs them.
  bool open(Cycle now, std::uint32_t places) {
    if (credits_ < places) take_credits(now);
    return queue_.empty() && free_at_ <= now && credits_ >= places;
  }
  /// Sends a packet past the egress queue. Inlined, as most of what a network does is that packets pass.
  [[gnu::always_inline]] void launch(const T& token, Cycle now, bool cut_through) { start(token, now, cut_through); }
  /// The time at which it will be open(), as far as is known and if nothing else is sent before.
  Cycle opens(std::uint32_t places) const {
    if (!queue_.empty()) return kNever;
    return credits_ >= places ? free_at_ : std::max(free_at_, next_credit());
  }
  /// The time at which something can be sent, as far as is known; `want_credit`: the next credit counts even if no
  /// packet in the egress queue waits for it.
  Cycle next(bool want_credit) const {
    const Cycle credit = want_credit || (credits_ == 0 && !queue_.empty()) ? next_credit() : kNever;
    if (queue_.empty() || credits_ == 0) return credit;
    return std::min(credit, wants_to_start());
  }

  /// launch() may not send a packet for want of credits only.
  bool lacks_credits(std::uint32_t places) const { return queue_.empty() && credits_ < places; }
  /// Nothing can be sent until a credit comes.
  bool awaits_credit() const { return credits_ == 0 && !queue_.empty(); }

  bool empty() const { return queue_.empty(); }
  std::size_t egress() const { return queue_.size(); }
  PacketId front() const { return queue_.front().token.packet; }  ///< only where T is Token
  const T& first() const { return queue_.front().token; }
  /// The time from which the first packet waits for a credit, if none comes before; kNever if it need not wait.
  Cycle blocked_from() const { return awaits_credit() ? wants_to_start() : kNever; }
  /// Cycles before `end` in which the link moved something; not before the last packet was sent.
  Cycle busy(Cycle end = kNever) const {
    if (near_ != nullptr) [[unlikely]]
      return busy_across(end);
    return free_at_ <= end ? busy_ : busy_ - std::min(busy_, free_at_ - end);
  }
  /// The same by the clock of the link; `end` by that of the sender.
  Cycle moved(Cycle end = kNever) const {
    if (near_ == nullptr) [[likely]]
      return busy(end);
    return end == kNever ? near_->busy : near_->moved(near_->to_link.to_network(end));
  }
  /// The first cycle in which another packet may be sent, for want of the link.
  Cycle free_at() const { return free_at_; }
  Cycle stalled() const { return stalled_; }  ///< cycles in which a packet waited for a credit
  std::uint64_t packets() const { return packets_; }
  std::uint64_t bytes() const { return wire_->packets.bytes_sent(); }
  LinkFaultCounts faults() const { return faults_ ? faults_->counts() : LinkFaultCounts{}; }

 private:
  struct Entry {
    T token;
    Cycle ready = 0;
    bool cut_through = false;
  };

  [[gnu::cold, gnu::noinline]] Cycle busy_across(Cycle end) const {
    const ClockRatio& to_link = near_->to_link;
    if (end == kNever) return to_link.before(near_->busy);
    const Cycle edge = to_link.floor_to_network(end), ended = near_->moved(edge);
    return to_link.part_before(ended, near_->moved(edge + 1) > ended, end);
  }
  Cycle wants_to_start() const { return std::max(free_at_, queue_.front().ready); }
  Cycle next_credit() const {
    const Cycle credit = wire_->packets.next_return();
    if (!faults_) return credit;
    const Cycle late = faults_->next();
    return std::min(credit, near_ == nullptr || late == kNever ? late : near_->to_link.to_core(late));
  }
  /// By the clock of the link, where that has another one.
  Cycle by_link(Cycle now) const { return near_ == nullptr ? now : near_->to_link.to_network(now); }
  /// Where some are lost.
  [[gnu::cold, gnu::noinline]] void take_uncertain_credits(Cycle now) {
    for (Cycle at; (at = wire_->packets.next_return()) <= now;) {
      wire_->packets.take_return();
      recover_credits(at);
      credits_ += faults_->acknowledge(by_link(at));
    }
    recover_credits(now);
  }
  /// Recovers credits that were lost on their way. Asking for them occupies the link like a packet, and does not count
  /// as waiting.
  void recover_credits(Cycle now) {
    const LinkFaultTimer::Recovered made = faults_->recovered(by_link(now));
    if (const Cycle blocked = blocked_from(); made.busy > 0 && blocked < now) stalled_ += now - blocked;
    credits_ += made.places;
    if (made.busy == 0) return;
    if (near_ != nullptr) {
      near_->moves(now, std::max(near_->link_free, by_link(now)) + made.busy, made.busy);
      free_at_ = std::max(free_at_, near_->leaves_for(near_->link_free));
      return;
    }
    free_at_ = std::max(free_at_, now) + made.busy;
    busy_ += made.busy;
  }
  [[gnu::always_inline]] void start(const T& token, Cycle now, bool cut_through) {
    const Cycle cycles = token.link_cycles;
    Flight flight{now + latency_ + (cut_through ? 0 : cycles - 1), now + cycles, cycles};
    if (!plain_) [[unlikely]]
      flight = near_ ? crossing_flight(now, cycles, cut_through) : uncertain_flight(now, cycles, cut_through);
    free_at_ = flight.link_free;
    wire_->packets.send(flight.arrival, token);
    if constexpr (std::is_same_v<T, Token>) {
      if (recorder_.wanted()) [[unlikely]]
        recorder_.note(token, now, free_at_, flight.arrival);
    }
    --credits_;
    busy_ += flight.busy;
    ++packets_;
  }
  using Flight = LinkFaultTimer::Delivery;
  /// Out of line, as few links have a clock of their own. The arrival is by the clock of the link.
  [[gnu::cold, gnu::noinline]] Flight crossing_flight(Cycle now, Cycle cycles, bool cut_through) {
    NearClock& near = *near_;
    const Cycle edge = std::max(near.to_link.enter(now + near.node_cycles), near.link_free);
    Flight flight{edge + latency_ + (cut_through ? 0 : cycles - 1), edge + cycles, cycles};
    if (faults_) flight = uncertain_flight(edge, cycles, cut_through);
    near.moves(now, flight.link_free, flight.busy);
    return {flight.arrival, std::max(now + 1, near.leaves_for(flight.link_free)), 0};
  }
  /// Out of line, as few links have faults.
  [[gnu::cold, gnu::noinline]] Flight uncertain_flight(Cycle now, Cycle cycles, bool cut_through) {
    Flight flight = faults_->send(now, cycles);
    // In order even where a head overtakes the tail before it.
    last_arrival_ = std::max(last_arrival_, flight.arrival + (cut_through ? 0 : cycles - 1));
    flight.arrival = last_arrival_;
    return flight;
  }

  WireOf<T>* wire_;
  Cycle latency_;
  std::uint32_t credits_;
  bool plain_ = true;  // neither faults_ nor near_
  std::size_t places_, reserved_ = 0;
  Fifo<Entry> queue_;
  Cycle free_at_ = 0, busy_ = 0, stalled_ = 0;
  std::uint64_t packets_ = 0;
  std::unique_ptr<LinkFaultTimer> faults_;  // null: it has none
  Cycle last_arrival_ = 0;                  // with faults
  std::unique_ptr<NearClock> near_;         // null: the link goes by the clock of its sender
  LinkRecorder recorder_;
};

using Wire = WireOf<Token>;
using InPort = InPortOf<Token>;
using OutPort = OutPortOf<Token>;

}  // namespace carousel::ringbus::cycle
