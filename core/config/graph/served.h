#pragma once

#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// Enters in a graph whose nodes are written out which packet process keeps the collections of which resources: of a
/// group, each those of an equal run of what the group serves. What is wrong is appended to `issues`.
void find_served(const TopologyConfig& config, Graph& graph, std::vector<GraphIssue>& issues);

}  // namespace carousel::config
