#pragma once

#include <functional>
#include <string>

#include "core/config/config.h"

namespace carousel::config {

/// Takes the breach of a rule: the key, and the rest of the message.
using RuleBreach = std::function<void(const std::string& key, std::string message)>;

/// The rules of topology, flow control, synthetic traffic and faults. `force` permits `flow: none`.
void check_network(const Config& config, bool force, const RuleBreach& breach);

/// The rules of a network that is drawn (`topology.shape: graph`).
void check_graph(const Config& config, const RuleBreach& breach);

/// The rules of pools of shader workers that are drawn.
void check_pools(const Config& config, const RuleBreach& breach);

/// The rules of rings whose stops have no queues, of the ends of synthetic traffic, and of clocks.
void check_rings(const Config& config, const RuleBreach& breach);

/// The rules of numbers that a resource has of its own.
void check_own(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
