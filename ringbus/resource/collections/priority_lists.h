#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

namespace carousel::ringbus {

/// Doubly linked lists in 256 buckets with a bit mask of the non-empty ones: insertion, removal and finding the first
/// of the lowest bucket take constant time. Elements are indices that the caller allocates.
class PriorityLists {
 public:
  static constexpr std::uint32_t kBuckets = 256;
  static constexpr std::uint32_t kNone = 0xffffffffu;

  PriorityLists() { heads_.fill(kNone), tails_.fill(kNone); }

  /// Makes room for elements below `count`; those present keep their place.
  void resize(std::size_t count) { nodes_.resize(count); }

  void push_back(std::uint32_t element, std::uint32_t bucket) {
    nodes_[element] = {tails_[bucket], kNone, bucket};
    (tails_[bucket] == kNone ? heads_[bucket] : nodes_[tails_[bucket]].next) = element;
    tails_[bucket] = element;
    mask_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
  }
  void push_front(std::uint32_t element, std::uint32_t bucket) {
    nodes_[element] = {kNone, heads_[bucket], bucket};
    (heads_[bucket] == kNone ? tails_[bucket] : nodes_[heads_[bucket]].previous) = element;
    heads_[bucket] = element;
    mask_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
  }
  void remove(std::uint32_t element) {
    const Node node = nodes_[element];
    (node.previous == kNone ? heads_[node.bucket] : nodes_[node.previous].next) = node.next;
    (node.next == kNone ? tails_[node.bucket] : nodes_[node.next].previous) = node.previous;
    if (heads_[node.bucket] == kNone) mask_[node.bucket / 64] &= ~(std::uint64_t{1} << (node.bucket % 64));
  }
  std::uint32_t bucket_of(std::uint32_t element) const { return nodes_[element].bucket; }
  std::optional<std::uint32_t> first() const {
    for (std::uint32_t word = 0; word < mask_.size(); ++word)
      if (mask_[word] != 0) return heads_[64 * word + static_cast<std::uint32_t>(std::countr_zero(mask_[word]))];
    return std::nullopt;
  }

 private:
  struct Node {
    std::uint32_t previous, next, bucket;
  };
  std::array<std::uint64_t, kBuckets / 64> mask_{};
  std::array<std::uint32_t, kBuckets> heads_, tails_;
  std::vector<Node> nodes_;
};

}  // namespace carousel::ringbus
