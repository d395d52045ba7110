#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/config/fields/engine.h"
#include "core/config/fields/topology.h"

namespace carousel::config {

/// Turns the schema of all configurations into that of one drawing: keys that name nodes take names and patterns of its
/// nodes alone, and keys that name clocks its clocks. An editor completes the names that are listed, which are each
/// group as a whole and its first nodes; the patterns take all that NodeNames finds.
void name_in_schema(nlohmann::ordered_json& schema, const TopologyConfig& topology, const ClocksConfig& clocks);

}  // namespace carousel::config
