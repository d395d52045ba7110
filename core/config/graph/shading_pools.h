#pragma once

#include <vector>

#include "core/config/graph/drawn_parts.h"

namespace carousel::config {

/// Enters in `parts`, whose pools are known, to which of them each resource's completed rays go, and from which its new
/// rays come: to the pool that names it (`serves`), or of the pools that name none to the nearest. What is wrong is
/// appended to `issues`. Returns whether each resource has a pool.
bool find_pools(const Graph& graph, DrawnParts& parts, std::vector<GraphIssue>& issues);

}  // namespace carousel::config
