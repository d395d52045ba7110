#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace carousel::ringbus::cycle {

/// One node of a stuck machine waits for a place at another.
struct Wait {
  std::uint32_t from = 0, to = 0;
  std::string packet;  ///< what would go there, with a ray of it
};

/// A circle of waits, told in one line, e.g. "resource 0 holds packet 3 ... for resource 1, which ..."; empty when
/// there is none.
std::string wait_cycle(const std::vector<Wait>& waits);

}  // namespace carousel::ringbus::cycle
