#include "ringbus/ranks/gather_timeline.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/packets/word_stream.h"

namespace carousel::ringbus {

namespace {

using Clock = std::chrono::steady_clock;

// A message of so many slices at most, that no rank needs room for two copies of a long timeline.
constexpr std::size_t kSlices = 1 << 14;
constexpr std::chrono::seconds kSilence{15};
// The first word of each, which tells it from what is left of a run whose ranks have parted.
constexpr std::uint64_t kMark = 0x656e696c656d6974;

std::vector<char> characters(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string text(WordReader& reader) {
  std::vector<char> out;
  reader.part(out);
  return {out.begin(), out.end()};
}

/// Only the tracks that have slices.
void drop_unused(Timeline& timeline) {
  std::vector<std::uint32_t> index(timeline.tracks.size(), 0);
  for (const Slice& slice : timeline.slices) index[slice.track] = 1;
  std::vector<SliceTrack> used;
  for (std::size_t t = 0; t < index.size(); ++t) {
    if (index[t] == 0) continue;
    index[t] = static_cast<std::uint32_t>(used.size());
    used.push_back(std::move(timeline.tracks[t]));
  }
  timeline.tracks = std::move(used);
  for (Slice& slice : timeline.slices) slice.track = index[slice.track];
}

void send_words(Transport& transport, const std::vector<std::uint64_t>& words) {
  transport.send(0, words);
  const Clock::time_point until = Clock::now() + kSilence;
  while (transport.leaving(0) > 0) {
    if (Clock::now() > until) throw SimulationError("rank 0 does not take the timeline; it hangs or has died");
    std::this_thread::yield();
  }
}

void send_timeline(Transport& transport, const Timeline& timeline) {
  std::vector<std::uint64_t> words;
  WordWriter head(words);
  head.part(kMark);
  head.part(timeline.end);
  head.part(timeline.cut);
  head.part(timeline.every);
  head.part(std::uint64_t{timeline.tracks.size()});
  for (const SliceTrack& track : timeline.tracks) {
    head.part(characters(track.part));
    head.part(characters(track.name));
  }
  head.part(std::uint64_t{timeline.slices.size()});
  send_words(transport, words);
  for (std::size_t at = 0; at < timeline.slices.size(); at += kSlices) {
    const auto begin = timeline.slices.begin() + static_cast<std::ptrdiff_t>(at);
    const std::size_t count = std::min(kSlices, timeline.slices.size() - at);
    words.clear();
    WordWriter some(words);
    some.part(kMark);
    some.part(std::vector<Slice>(begin, begin + static_cast<std::ptrdiff_t>(count)));
    send_words(transport, words);
  }
}

/// The timelines of the other ranks as their messages come, in any order.
class TimelineReader {
 public:
  explicit TimelineReader(std::uint32_t ranks) : of_(ranks), left_(ranks, 0), begun_(ranks, false) { begun_[0] = true; }

  std::vector<Timeline> read(Transport& transport) {
    Clock::time_point heard = Clock::now();
    std::vector<std::uint64_t> words;
    for (std::size_t rank = 0; (rank = missing()) < of_.size();) {
      std::uint32_t from = 0;
      if (!transport.receive(from, words)) {
        if (Clock::now() - heard > kSilence)
          throw SimulationError(fmt::format("rank {} does not send its timeline; it hangs or has died", rank));
        std::this_thread::yield();
        continue;
      }
      std::uint64_t mark = 0;
      WordReader reader(words);
      reader.part(mark);
      if (mark != kMark) continue;
      heard = Clock::now();
      if (begun_[from])
        take_slices(reader, from);
      else
        take_head(reader, from);
    }
    return std::move(of_);
  }

 private:
  /// A rank of which something has not come; the number of ranks if there is none.
  std::size_t missing() const {
    std::size_t r = 0;
    while (r < of_.size() && begun_[r] && left_[r] == 0) ++r;
    return r;
  }
  void take_head(WordReader& reader, std::uint32_t from) {
    Timeline& timeline = of_[from];
    std::uint64_t tracks = 0;
    reader.part(timeline.end);
    reader.part(timeline.cut);
    reader.part(timeline.every);
    reader.part(tracks);
    for (; tracks > 0; --tracks) {
      std::string part = text(reader);
      timeline.tracks.push_back({std::move(part), text(reader)});
    }
    reader.part(left_[from]);
    begun_[from] = true;
  }
  void take_slices(WordReader& reader, std::uint32_t from) {
    std::vector<Slice> slices;
    reader.part(slices);
    if (slices.size() > left_[from]) throw SimulationError(fmt::format("rank {} sends more slices than it has", from));
    left_[from] -= slices.size();
    of_[from].slices.insert(of_[from].slices.end(), slices.begin(), slices.end());
  }

  std::vector<Timeline> of_;
  std::vector<std::uint64_t> left_;  // slices to come
  std::vector<bool> begun_;
};

/// A time of a clock that has gained `gain` nanoseconds at `end`.
std::uint64_t without_drift(std::uint64_t at, double gain, std::uint64_t end) {
  if (end == 0) return at;
  const double share = static_cast<double>(at) / static_cast<double>(end);
  return static_cast<std::uint64_t>(
      std::max<std::int64_t>(0, static_cast<std::int64_t>(at) - std::llround(gain * share)));
}

}  // namespace

void gather_timeline(Transport& transport, const std::vector<RankClock>& first, const std::vector<RankClock>& last,
                     Timeline& timeline) {
  drop_unused(timeline);
  if (transport.rank() != 0) return send_timeline(transport, timeline);
  std::vector<Timeline> others = TimelineReader(transport.ranks()).read(transport);
  for (std::uint32_t r = 0; r < others.size(); ++r) {
    timeline.clocks.push_back({first[r].ahead, std::max(first[r].uncertainty, last[r].uncertainty)});
    const auto gain = static_cast<double>(last[r].ahead - first[r].ahead);
    const auto base = static_cast<std::uint32_t>(timeline.tracks.size());
    Timeline& other = others[r];
    timeline.end = std::max(timeline.end, without_drift(other.end, gain, other.end));
    timeline.cut |= other.cut;
    timeline.every = std::max(timeline.every, other.every);
    for (SliceTrack& track : other.tracks) timeline.tracks.push_back(std::move(track));
    for (Slice slice : other.slices) {
      slice.track += base;
      slice.begin = without_drift(slice.begin, gain, other.end);
      slice.end = without_drift(slice.end, gain, other.end);
      timeline.slices.push_back(slice);
    }
    other = {};
  }
  thin(timeline.slices, timeline.every);
  sort_slices(timeline.slices);
}

}  // namespace carousel::ringbus
