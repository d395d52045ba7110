#pragma once

#include <string>

namespace carousel::app {

/// The text of `carousel --version`: version, commit, compiler, SIMD targets.
std::string version_text();

}  // namespace carousel::app
