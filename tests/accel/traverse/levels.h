#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/types/enum_names.h"

namespace carousel {

/// For Google Test's messages.
inline void PrintTo(const AccuracyConfig& accuracy, std::ostream* out) {
  *out << enum_name(accuracy.triangle) << " and " << enum_name(accuracy.box);
}

}  // namespace carousel

namespace carousel::accel {

inline std::string text(const AccuracyConfig& accuracy) {
  return std::string(enum_name(accuracy.triangle)) + " and " + std::string(enum_name(accuracy.box));
}

/// Every level of the triangle test with every level of the box test.
inline std::vector<AccuracyConfig> triangle_and_box_levels() {
  std::vector<AccuracyConfig> levels;
  for (const auto& triangle : kEnumNames<TriangleLevel>) {
    for (const auto& box : kEnumNames<BoxLevel>) {
      AccuracyConfig& accuracy = levels.emplace_back();
      accuracy.triangle = triangle.value;
      accuracy.box = box.value;
    }
  }
  return levels;
}

}  // namespace carousel::accel
