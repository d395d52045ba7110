#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/config/fields/topology.h"
#include "core/numeric/grow.h"
#include "core/statistics/shape_buffer_counts.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/shapes/shape_port.h"
#include "ringbus/results/class_use.h"

namespace carousel::ringbus::cycle {

/// The shape data that a resource has at hand, or on its way from its cache: at most `memory.shape_buffer_kib`, in
/// places of 64 bytes, any of which can hold any part of a span.
///
/// Test contexts, rays and packets of the issue queue are its users, numbered from 0 on. A user takes all that it
/// needs for its next test together, and gives it back when the test has ended. Until then the data keeps its places.
/// A span that is not there is fetched, once for all who want it (D. Kroft, Lockup-free instruction fetch/prefetch
/// cache organization, ISCA 1981), and is there when its last line has arrived. Its places are taken when it is asked
/// for: free ones first, then those of the spans that nobody holds, the one given back longest ago first. A user that
/// does not find room waits, and holds nothing meanwhile; such users are served in the order in which they came, and
/// whoever needs room waits behind them. So a user that holds something never waits for room, and nothing can block.
///
/// With `memory.shape_stay: while_used` a span's places are free as soon as nobody holds it, so that only spans that
/// another resource's request has brought, and that a packet on its way will use, are replaced (US 9633468: shapes
/// have the room that packets ready for test need, and none is kept without any indication of when it is used next).
///
/// A strip that ends by its flag takes places for the longest strip of its kind, and those that it does not need are
/// free again when it has come.
///
/// Packets of the issue queue take their data in advance, in the order of the queue, and only while no test waits for
/// room. When a test finds too little room, they give up their data, the last packet first.
class ShapeBuffer {
 public:
  using User = std::uint32_t;
  static constexpr std::uint64_t kPlaceBytes = 64;
  static std::uint64_t places(const ShapeSpan& span) { return ceil_div(span.bytes, kPlaceBytes); }
  /// The places that a span needs before it is fetched.
  static std::uint64_t places_to_ask(const ShapeSpan& span) {
    return ceil_div(std::max(span.bytes, span.most), kPlaceBytes);
  }

  ShapeBuffer(const MemoryConfig& config, const LinkConfig& link, const SidePorts& ports);

  /// What is there and nobody holds, that which was used last first.
  std::vector<BufferedShapes> kept() const;
  /// Before the start: holds these as well, as far as there are free places, as used before all that is there already.
  void warm(const std::vector<BufferedShapes>& shapes, double part);

  /// Takes what `user`, which holds nothing, needs for a test. Returns whether all is there; if not, the user waits,
  /// and will be among ready().
  bool take(User user, const ShapeNeed& need, Cycle now);
  /// Ends the hold of a user, or its wait.
  void release(User user, Cycle now);
  /// `to`, which holds nothing, gets all that `from` has, which must be all there.
  void hand_over(User from, User to);

  /// Takes what a packet that joins the issue queue will need, as soon as there is room. Where it is fetched, `others`
  /// (a bit for each client of the cache) get it too.
  void take_ahead(User user, const ShapeNeed& need, Cycle now, std::uint64_t others = 0);
  /// Tells whether all that `user` took is there.
  bool is_here(User user) const { return users_[user].state == State::kHolds && users_[user].missing == 0; }
  /// The cycle since which it has been. Only if it is.
  Cycle here_since(User user) const { return users_[user].complete_at; }
  /// Tells whether a span is there, for whoever would take it.
  bool has(const ShapeSpan& span) const {
    const std::uint32_t entry = find(span);
    return entry != kNone && entries_[entry].here;
  }
  /// The first packet leaves the issue queue. Its user must have all; afterwards it holds it like a test.
  void leave_queue(User user);
  /// All packets leave the issue queue; they give back what they hold.
  void clear_queue(Cycle now);

  /// The time at which the next answer comes from the cache.
  Cycle next() const { return pushed_ == nullptr ? port_.next() : std::min(port_.next(), pushed_->next()); }
  /// Takes in the answers that have come.
  void take_answers(Cycle now);
  /// The wires to the cache, by which spilled collection entries go as well.
  ShapePort& port() { return port_; }
  /// Tags of the reads of spilled entries that have been answered, without kSpillTag. The caller empties it.
  std::vector<std::uint32_t>& spill_answers() { return spill_answers_; }
  /// Users who waited and need wait no longer, in the order in which their data was complete. The caller empties it.
  std::vector<User>& ready() { return ready_; }
  /// Tells whether anything has changed for the issue queue since forget_changes().
  bool queue_has_changed() const { return queue_changed_; }
  void forget_changes() { queue_changed_ = false; }

  std::size_t fetches() const { return fetches_; }  ///< on their way
  const ShapeBufferCounts& counts() const { return counts_; }
  /// By row of accel::StructureDepths, up to the last that was needed.
  const std::vector<StripReads>& reads() const { return reads_; }

 private:
  static constexpr std::uint32_t kNone = ~0u;
  /// A span in the buffer, in a line of the host's cache. Its index is the tag of its fetch.
  struct alignas(64) Entry {
    ShapeSpan span;
    std::uint64_t places = 0;
    std::uint32_t holders = 0;
    bool here = false;
    std::uint32_t chain = kNone;                 // the next entry of its bucket, or of the free ones
    std::uint32_t older = kNone, newer = kNone;  // among those that nobody holds
    std::uint32_t first_wait = kNone, last_wait = kNone;
  };
  enum class State : std::uint8_t { kNothing, kWaits, kHolds };
  /// A span of a user's need: its entry, and the wait behind the user's at it.
  struct Hold {
    std::uint32_t entry = kNone, next_wait = kNone;
  };
  static constexpr std::size_t kNear = 2;  // spans of most needs
  /// Short, as rays in subtrees are users, and all of them wait in turn.
  struct UserState {
    State state = State::kNothing;
    bool ahead = false;                   // in the issue queue
    std::uint8_t missing = 0, spans = 0;  // of its need: those that have not come, and all
    std::array<Hold, kNear> near{};       // the first ones
    Cycle complete_at = 0;                // the last span came, or all were there
  };
  static_assert(ShapeNeed::kMost <= 32);
  /// Of a user that waits for room.
  struct Request {
    ShapeNeed need;
    std::uint64_t others = 0;  // that get it too; of a packet of the issue queue
  };

  /// A user's wait for one of its spans, as a number.
  static std::uint32_t wait_of(User user, std::size_t which) { return user << 5 | static_cast<std::uint32_t>(which); }
  static User user_of(std::uint32_t wait) { return wait >> 5; }
  std::uint32_t& next_wait(std::uint32_t wait) { return hold_of(user_of(wait), wait & 31).next_wait; }
  Hold& hold_of(User user, std::size_t which) {
    return which < kNear ? users_[user].near[which] : far_[user][which - kNear];
  }
  UserState& state_of(User user) {
    grow_to(users_, user + std::size_t{1});
    grow_to(requests_, user + std::size_t{1});
    return users_[user];
  }
  bool grant(User user, const ShapeNeed& need, bool test, Cycle now);
  std::uint32_t find(const ShapeSpan& span) const;
  void remove(std::uint32_t entry);
  void keep(std::uint32_t entry);
  std::uint32_t allocate(const ShapeSpan& span, std::uint64_t places);
  void evict_oldest();
  void hold(std::uint32_t entry);
  void let_go(std::uint32_t entry);
  void wait_for(std::uint32_t entry, User user, std::size_t which);
  void stop_waiting(std::uint32_t entry, std::uint32_t wait);
  void drop(UserState& state, User user);
  void serve(Cycle now);
  void count_read(std::uint16_t row, bool missed) {
    if (row == accel::StructureDepths::kNoRow) return;
    grow_to(reads_, row + std::size_t{1});
    ++reads_[row].needed;
    reads_[row].misses += missed;
  }
  void grow_buckets();
  void take_pushed(Cycle now);
  std::size_t bucket(const ShapeSpan& span) const {
    return static_cast<std::size_t>((span.address + span.bytes) * 0x9e3779b97f4a7c15ull >> shift_);
  }

  ShapePort port_;
  Channel<PushedShapes>* pushed_;
  bool drops_;                                            // shapes that nobody holds are dropped
  std::uint64_t places_, free_places_, idle_places_ = 0;  // idle: of spans that are here and nobody holds
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> buckets_;
  int shift_;
  std::size_t used_ = 0;  // entries
  std::uint32_t free_entry_ = kNone, oldest_ = kNone, newest_ = kNone;
  std::vector<UserState> users_;
  std::vector<std::array<Hold, ShapeNeed::kMost - kNear>> far_;  // by user: its other spans
  std::vector<Request> requests_;                                // by user
  std::deque<User> room_;                                        // tests that wait for room
  std::deque<User> queue_;                                       // packets of the issue queue
  std::size_t granted_ = 0;                                      // the first packets of the queue, which have places
  std::vector<User> ready_;
  std::vector<std::uint32_t> spill_answers_;
  bool queue_changed_ = false;
  std::size_t fetches_ = 0;
  ShapeBufferCounts counts_;
  std::vector<StripReads> reads_;
};

}  // namespace carousel::ringbus::cycle
