#pragma once

#include "app/run/prepare.h"

namespace carousel::app {

/// Logs, at level debug, what follows from the configuration for the machine: links, packets, flow, storage, kernels.
/// Warns of a key that this host cannot follow.
void log_machine(const Prepared& prepared);

}  // namespace carousel::app
