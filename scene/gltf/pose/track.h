#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carousel::scene {

enum class Interpolation : std::uint8_t { kLinear, kStep, kCubicSpline };

/// A value that changes with time: the keys of a sampler of an animation.
struct Track {
  Interpolation interpolation = Interpolation::kLinear;
  std::size_t width = 1;      ///< numbers a value
  std::vector<float> times;   ///< seconds, one at least, each greater than the one before
  std::vector<float> values;  ///< `width` numbers a key; for cubic splines in-tangent, value and out-tangent a key
  bool rotation = false;      ///< the values are quaternions (x, y, z, w), none of them zero

  /// The value at a time, that of the first key before it and that of the last key after it. glTF specification,
  /// appendix C. A rotation is a unit quaternion, but for the weighted sum of cubic splines, which may be zero.
  std::vector<double> at(double seconds) const;
};

}  // namespace carousel::scene
