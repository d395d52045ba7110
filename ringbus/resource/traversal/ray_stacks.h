#pragma once

#include <cstdint>
#include <memory>

#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// The nodes an ordered ray has yet to visit, nearest on top, one short stack beside each record. Storage for
/// the deepest stack possible is set aside but only touched as far as stacks grow.
class RayStacks {
 public:
  /// A node leaves at most width - 1 siblings a level behind.
  RayStacks(std::size_t slots, int width, int max_depth)
      : capacity_(static_cast<std::size_t>(width - 1) * static_cast<std::size_t>(max_depth) + 1),
        sizes_(std::make_unique<std::uint16_t[]>(slots)),
        entries_(std::make_unique_for_overwrite<NextNode[]>(slots * capacity_)) {}

  void clear(std::uint32_t slot) { sizes_[slot] = 0; }
  void push(std::uint32_t slot, const NextNode& node) { entries_[slot * capacity_ + sizes_[slot]++] = node; }
  /// The nearest node that is not beyond `tmax`; `any` is false when there is none.
  NextNode pop(std::uint32_t slot, float tmax) {
    while (sizes_[slot] > 0) {
      const NextNode& top = entries_[slot * capacity_ + --sizes_[slot]];
      if (!(top.entry > tmax)) return top;
    }
    return {};
  }
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_;
  std::unique_ptr<std::uint16_t[]> sizes_;
  std::unique_ptr<NextNode[]> entries_;
};

}  // namespace carousel::ringbus
