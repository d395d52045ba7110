#include "report/accuracy/free_place.h"

#include <cmath>

namespace carousel::report {

bool FreePlace::is_free(const Place& p) const {
  if (p.x - kHalfWidth < frame_.left || p.x + kHalfWidth > frame_.right || p.y - kHalfHeight < frame_.top ||
      p.y + kHalfHeight > frame_.bottom)
    return false;
  for (const Place& dot : dots_)
    if (std::abs(dot.x - p.x) < kHalfWidth + 5 && std::abs(dot.y - p.y) < kHalfHeight + 5) return false;
  for (const Place& number : numbers_)
    if (std::abs(number.x - p.x) < 2 * kHalfWidth && std::abs(number.y - p.y) < 2 * kHalfHeight) return false;
  return true;
}

Place FreePlace::near(double x, double y) {
  constexpr double kPi = 3.14159265358979;
  constexpr int kDirections = 16;
  for (double radius = 15; radius < 200; radius += 4) {
    for (int i = 0; i < kDirections; ++i) {
      // Upwards first, then alternately to both sides.
      const double angle = -kPi / 2 + (i % 2 == 0 ? 1 : -1) * ((i + 1) / 2) * 2 * kPi / kDirections;
      const Place place{x + radius * std::cos(angle), y + radius * std::sin(angle)};
      if (!is_free(place)) continue;
      numbers_.push_back(place);
      return place;
    }
  }
  numbers_.push_back({x, y - 15});
  return numbers_.back();
}

}  // namespace carousel::report
