#pragma once

#include <bit>
#include <cstdint>

#include "core/types/ids.h"

namespace carousel::ringbus {

#ifdef CAROUSEL_CHECKED
inline constexpr bool kChecked = true;
#else
inline constexpr bool kChecked = false;
#endif

/// How often a slot has been handed out or freed; empty unless the build is checked.
template <bool kPresent>
class Generation {
 public:
  std::uint32_t get() const { return count_; }
  void set(std::uint32_t count) { count_ = count; }

 private:
  std::uint32_t count_ = 0;
};
template <>
class Generation<false> {
 public:
  std::uint32_t get() const { return 0; }
  void set(std::uint32_t) {}
};

/// Names a ray by its owner and slot. RayIdLayout splits the bits.
struct RayId {
  std::uint32_t bits = 0;
  [[no_unique_address]] Generation<kChecked> generation;
};

/// Slot in the low bits, owner above it. Needs bit_width(resources - 1) + bit_width(slots - 1) <= 32.
class RayIdLayout {
 public:
  explicit RayIdLayout(std::uint32_t slots_per_resource) : slot_bits_(std::bit_width(slots_per_resource - 1)) {}

  RayId make(ResourceId owner, std::uint32_t slot) const {
    RayId id;
    id.bits = static_cast<std::uint32_t>(std::uint64_t{owner.value} << slot_bits_) | slot;
    return id;
  }
  ResourceId owner(RayId id) const {
    return ResourceId(static_cast<std::uint32_t>(std::uint64_t{id.bits} >> slot_bits_));
  }
  std::uint32_t slot(RayId id) const {
    return id.bits & static_cast<std::uint32_t>((std::uint64_t{1} << slot_bits_) - 1);
  }

 private:
  int slot_bits_;
};

}  // namespace carousel::ringbus
