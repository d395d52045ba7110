#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace carousel::shading {

/// The volumes that a path is in, by material, the innermost first: a drop in a bottle is left into the bottle, not
/// into the open. A path in more volumes than there is room for does not notice the innermost ones. A camera inside a
/// volume starts outside of it, and leaving a volume that was never entered changes nothing.
class VolumeStack {
 public:
  /// The innermost volume's material, plus 1; 0 outside of all.
  std::uint32_t innermost() const { return inside_[0]; }
  void enter(std::uint32_t material) {
    if (inside_.back() != 0) return;
    std::copy_backward(inside_.begin(), inside_.end() - 1, inside_.end());
    inside_[0] = material + 1;
  }
  void leave(std::uint32_t material) {
    const auto left = std::find(inside_.begin(), inside_.end(), material + 1);
    if (left == inside_.end()) return;
    std::copy(left + 1, inside_.end(), left);
    inside_.back() = 0;
  }

 private:
  std::array<std::uint32_t, 4> inside_{};
};

}  // namespace carousel::shading
