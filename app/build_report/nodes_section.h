#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/node_counts.h"
#include "report/sections/structure/nodes.h"

namespace carousel::app {

/// The nodes of the structure by depth, beside the work counted at each depth.
report::Nodes nodes_section(const accel::Accel& accel, const std::vector<NodeCounts>& work);

}  // namespace carousel::app
