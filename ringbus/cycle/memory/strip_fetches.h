#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "ringbus/cycle/memory/shape_port.h"

namespace carousel::ringbus::cycle {

/// Strips that rays of one resource wait for. Each is fetched once, however many rays want it (D. Kroft, Lockup-free
/// instruction fetch/prefetch cache organization, ISCA 1981, for single rays).
class StripFetches {
 public:
  StripFetches(const MemoryConfig& config, const SidePorts& ports) : port_(config, ports) {}

  /// Returns whether the strip is at hand; otherwise `slot` waits for it from now on.
  bool want(const ShapeSpan& strip, std::uint32_t slot, Cycle now) {
    if (port_.has(strip)) return true;
    const auto [found, first] = under_way_.try_emplace(strip.address, 0);
    if (first) {
      found->second = free_tag();
      fetches_[found->second].strip = strip;
      port_.request(strip, found->second, now);
    }
    fetches_[found->second].waiting.push_back(slot);
    return false;
  }

  /// The time at which the next strip comes.
  Cycle next() const { return port_.next(); }
  /// Takes the next strip in. Returns the slots that waited for it, in the order in which they began to wait; valid
  /// until the next call.
  std::span<const std::uint32_t> take() {
    const std::uint32_t tag = port_.take();
    Fetch& fetch = fetches_[tag];
    port_.keep(fetch.strip);
    under_way_.erase(fetch.strip.address);
    free_tags_.push_back(tag);
    arrived_.swap(fetch.waiting);
    fetch.waiting.clear();
    return arrived_;
  }
  bool empty() const { return under_way_.empty(); }

 private:
  struct Fetch {
    ShapeSpan strip;
    std::vector<std::uint32_t> waiting;
  };

  std::uint32_t free_tag() {
    if (free_tags_.empty()) {
      fetches_.emplace_back();
      return static_cast<std::uint32_t>(fetches_.size() - 1);
    }
    const std::uint32_t tag = free_tags_.back();
    free_tags_.pop_back();
    return tag;
  }

  ShapePort port_;
  std::vector<Fetch> fetches_;  // by tag
  std::vector<std::uint32_t> free_tags_, arrived_;
  std::unordered_map<std::uint64_t, std::uint32_t> under_way_;  // a strip's address to its tag
};

}  // namespace carousel::ringbus::cycle
