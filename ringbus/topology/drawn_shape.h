#pragma once

#include <string>

#include "core/config/fields/topology.h"

namespace carousel::ringbus {

/// A shape as the graph that it is.
struct DrawnShape {
  TopologyConfig config;   ///< of shape: graph
  bool same = true;        ///< run as this graph, a machine takes the same cycles
  std::string difference;  ///< what is different
};

/// Draws a shape. The graph names its resources r[0] and on, a hierarchical network's bridges bridge[0] and on, a bus
/// bus, and a central machine unit. `traffic`: for synthetic packets, which keep their lanes on rings.
DrawnShape draw_shape(const TopologyConfig& config, bool traffic = false);

}  // namespace carousel::ringbus
