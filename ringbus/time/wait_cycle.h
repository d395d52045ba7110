#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace carousel::ringbus {

/// One node of a stuck machine waits for a place at another.
struct Wait {
  std::uint32_t from = 0, to = 0;
  std::string packet;  ///< the packet that would go there, with its first ray
};

/// Finds a circle of waits and describes it in one line, e.g. "a circle of waits: resource 0 has packet 3 for resource
/// 1; ..."; empty when there is none.
std::string wait_cycle(const std::vector<Wait>& waits);

}  // namespace carousel::ringbus
