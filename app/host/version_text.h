#pragma once

#include <string>

namespace carousel::app {

/// What `carousel --version` prints: version, commit, compiler, SIMD targets.
std::string version_text();

}  // namespace carousel::app
