#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

namespace carousel::ringbus {

/// The work of a part of the machine during a slice of time.
enum class SliceKind : std::uint8_t {
  kIssue,    ///< dispatch reads a packet of its own, which then leaves or is tested
  kVisit,    ///< dispatch reads a packet of another resource
  kPass,     ///< likewise, of a packet without rays here
  kRetire,   ///< dispatch takes a packet of its own back
  kTest,     ///< a packet is in a test context
  kLink,     ///< a packet occupies a link
  kUnits,    ///< units of one kind are at work
  kSend,     ///< native: a message to another rank is written and given away
  kReceive,  ///< native: one of another rank is taken apart
};

/// Times are cycles, or nanoseconds since the start in the native engine.
struct Slice {
  std::uint64_t begin = 0, end = 0;
  std::uint64_t trip = 0;   ///< the way of a packet from its issue until it retires, or of a message; 0: of neither
  std::uint64_t at = 0;     ///< kTest: the beginning of its tests; kLink: its arrival at the far end
  std::uint32_t track = 0;  ///< a part of the machine that does one thing at a time
  std::uint32_t packet = 0, rays = 0;  ///< a message's number among those to its rank, and its packets
  SliceKind kind = SliceKind::kUnits;
  friend bool operator==(const Slice&, const Slice&) = default;
};

/// A part of the machine that has slices.
struct SliceTrack {
  std::string part;  ///< as in the time series: resource N, or links
  std::string name;  ///< within it
  friend bool operator==(const SliceTrack&, const SliceTrack&) = default;
};

/// In the order of a timeline.
inline void sort_slices(std::vector<Slice>& slices) {
  std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) {
    return std::tie(a.begin, a.track) < std::tie(b.begin, b.track);
  });
}

/// The clock of a rank beside rank 0's.
struct RankClock {
  std::int64_t ahead = 0;         ///< nanoseconds
  std::uint64_t uncertainty = 0;  ///< nanoseconds by which `ahead` may be wrong; 0: it is rank 0's clock
  friend bool operator==(const RankClock&, const RankClock&) = default;
};

/// Slices of a run, and where they come from.
struct Timeline {
  std::vector<SliceTrack> tracks;
  std::vector<Slice> slices;        ///< by begin, then track
  std::uint64_t end = 0;            ///< the end of the run
  bool cut = false;                 ///< recording ended before the run did, for there were too many
  std::uint64_t every = 1;          ///< one of about so many packets is here, for there were too many
  std::vector<RankClock> clocks{};  ///< one for each rank whose slices are here, on rank 0's clock; empty: one process
  friend bool operator==(const Timeline&, const Timeline&) = default;
};

/// True for those trips that are left where one of `every` is, a power of 2: of the same trips fewer and fewer. Those
/// of no packet are left where all are.
inline bool is_left(const Slice& slice, std::uint64_t every) {
  if (every == 1) return true;
  const std::uint64_t mixed = (slice.trip ^ slice.trip >> 29) * 0x9e3779b97f4a7c15ull;
  return slice.trip != 0 && ((mixed ^ mixed >> 32) & (every - 1)) == 0;
}

/// Leaves one of `every` packets.
inline void thin(std::vector<Slice>& slices, std::uint64_t every) {
  std::erase_if(slices, [&](const Slice& slice) { return !is_left(slice, every); });
}

/// The slices that are wanted.
struct TimelineOptions {
  std::uint64_t first = 0, end = std::numeric_limits<std::uint64_t>::max();  ///< window in which they begin
  std::uint64_t every = 1;  ///< one of so many packets of each resource is recorded; units only if it is 1
  std::size_t most = 0;     ///< about; 0: none is recorded
  bool thins = false;       ///< beyond `most`, half of the packets are left out instead of what comes later
};

/// Slices of one agent or thread, in the order in which they ended.
class SliceLog {
 public:
  /// At most `room` slices.
  explicit SliceLog(const TimelineOptions& options, std::size_t room = std::numeric_limits<std::size_t>::max())
      : options_(options), room_(room) {}

  void add(const Slice& slice) {
    if (!recording_ || slice.begin < options_.first || slice.begin >= options_.end) return;
    if ((slice.trip == 0 && options_.every != 1) || !is_left(slice, left_)) return;
    slices_.push_back(slice);
    if (slices_.size() < room_) return;
    if (options_.thins)
      halve();
    else
      stop();
  }
  /// Leaves out half of the packets that are recorded, and of those to come.
  void halve() {
    left_ *= 2;
    thin(slices_, left_);
  }
  /// One of about so many packets is left.
  std::uint64_t left() const { return left_; }
  /// Tells whether the next packet that is issued here is to be recorded.
  bool wants_next() { return options_.every > 0 && issued_++ % options_.every == 0; }
  /// Nothing is added any more.
  void stop() { recording_ = false; }
  /// Some may be missing.
  bool stopped() const { return !recording_; }
  const std::vector<Slice>& slices() const { return slices_; }

 private:
  TimelineOptions options_;
  std::size_t room_;
  std::vector<Slice> slices_;
  std::uint64_t issued_ = 0, left_ = 1;
  bool recording_ = true;
};

/// The trips of packets that are recorded: written by the packet's owner when it issues the packet, and read by those
/// to whom the packet has been passed since. Each rank has its own.
class TripTable {
 public:
  explicit TripTable(std::size_t packets) : trips_(packets) {}

  void issue(std::uint32_t packet, bool recorded) {
    Trip& trip = trips_[packet];
    ++trip.count;
    trip.recorded = recorded;
  }
  /// The packet has come from another rank, where its trip was `trip`.
  void bring(std::uint32_t packet, std::uint64_t trip) {
    trips_[packet].recorded = trip != 0;
    if (trip != 0) trips_[packet].count = trip / trips_.size();
  }
  /// 0 if it is not recorded. Different for every trip of every packet.
  std::uint64_t of(std::uint32_t packet) const {
    const Trip& trip = trips_[packet];
    return trip.recorded ? trip.count * trips_.size() + packet : 0;
  }

 private:
  struct Trip {
    std::uint64_t count = 0;  // number of the present trip, from 1 on
    bool recorded = false;
  };
  std::vector<Trip> trips_;
};

}  // namespace carousel::ringbus
