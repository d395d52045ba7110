#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/ringbus/identity/machine_space.h"

namespace carousel::ringbus {

/// Levels a and b of the factors f < g.
struct LevelPair {
  std::size_t f, g;
  int a, b;
};

/// Machines such that each pair of levels that a machine can have stands in one of them. Pairs of which one level
/// leaves the other's key unread are no pairs.
struct CoveringArray {
  std::vector<Row> rows;
  std::size_t pairs = 0;              ///< that the conditions of the factors permit
  std::size_t covered = 0;            ///< that stand in a row
  std::vector<LevelPair> infeasible;  ///< that the validator refuses in every machine tried
};

/// D. M. Cohen et al., "The AETG system: an approach to testing based on combinatorial design", 1997, with a fixed
/// seed.
CoveringArray covering_array(MachineSpace& space, std::uint32_t seed);

}  // namespace carousel::ringbus
