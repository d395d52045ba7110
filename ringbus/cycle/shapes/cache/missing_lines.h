#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/shapes/cache/index_pool.h"

namespace carousel::ringbus::cycle {

/// The lines that are on their way to a cache, each with the requests that wait for it, in the order in which they
/// came. A hash table in chains; nothing is allocated once it has grown.
class MissingLines {
 public:
  MissingLines() : buckets_(64, kNone) {}

  /// From now on `request` waits for `line`. Returns whether it is the first.
  bool wait(std::uint64_t line, std::uint32_t request) {
    const std::uint32_t wait = waits_.take({request, kNone});
    std::uint32_t at = buckets_[bucket(line)];
    while (at != kNone && lines_[at].line != line) at = lines_[at].chain;
    if (at != kNone) {
      waits_[lines_[at].last].next = wait;
      lines_[at].last = wait;
      return false;
    }
    if (++size_ > buckets_.size()) grow();
    std::uint32_t& first = buckets_[bucket(line)];
    first = lines_.take({line, first, wait, wait});
    return true;
  }
  bool has(std::uint64_t line) const {
    std::uint32_t at = buckets_[bucket(line)];
    while (at != kNone && lines_[at].line != line) at = lines_[at].chain;
    return at != kNone;
  }
  /// The line, which is on its way, has come: calls `body(request)` for all who wait for it.
  template <class Body>
  void come(std::uint64_t line, const Body& body) {
    std::uint32_t* at = &buckets_[bucket(line)];
    while (lines_[*at].line != line) at = &lines_[*at].chain;
    const std::uint32_t index = *at;
    *at = lines_[index].chain;
    for (std::uint32_t wait = lines_[index].first; wait != kNone;) {
      const Wait one = waits_[wait];
      waits_.give_back(wait);
      body(one.request);
      wait = one.next;
    }
    lines_.give_back(index);
    --size_;
  }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::uint32_t kNone = ~0u;
  struct Line {
    std::uint64_t line = 0;
    std::uint32_t chain = kNone;  // the next one of its bucket
    std::uint32_t first = kNone, last = kNone;
  };
  struct Wait {
    std::uint32_t request = 0, next = kNone;
  };

  std::size_t bucket(std::uint64_t line) const {
    return static_cast<std::size_t>(line * 0x9e3779b97f4a7c15ull >> 32) & (buckets_.size() - 1);
  }
  void grow() {
    std::vector<std::uint32_t> old(2 * buckets_.size(), kNone);
    old.swap(buckets_);
    for (std::uint32_t at : old)
      while (at != kNone) {
        const std::uint32_t next = lines_[at].chain;
        std::uint32_t& first = buckets_[bucket(lines_[at].line)];
        lines_[at].chain = first;
        first = at;
        at = next;
      }
  }

  std::vector<std::uint32_t> buckets_;  // their number is a power of two
  IndexPool<Line> lines_;
  IndexPool<Wait> waits_;
  std::size_t size_ = 0;
};

}  // namespace carousel::ringbus::cycle
