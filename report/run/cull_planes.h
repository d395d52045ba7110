#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace carousel::report {

/// What cull planes did for the children of nodes at one depth.
struct CullPlaneLevel {
  std::string structure;
  std::uint64_t depth = 0, children_tested = 0, plane_tests = 0, culled = 0;
  std::uint64_t box_tests_spared = 0, nodes_spared = 0, leaves_spared = 0, triangle_tests_spared = 0,
                transforms_spared = 0;
};

struct CullPlanes {
  std::uint64_t planes = 0, bytes = 0;
  double bytes_per_node = 0;
  std::vector<CullPlaneLevel> levels{};
};

}  // namespace carousel::report
