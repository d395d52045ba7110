#pragma once

#include "core/config/fields/engine.h"
#include "core/config/fields/image.h"
#include "core/config/fields/workload.h"

namespace carousel::app {

/// Makes sure that the modules are there which a configuration calls for by itself, before its scene is loaded: those
/// that write its pictures and that join it with other ranks. Loading tells of what the files of the scene need. Throws
/// a ConfigError with the key and the package.
void require_modules(const EngineConfig& engine, const WorkloadConfig& workload, const ImageConfig& image);

}  // namespace carousel::app
