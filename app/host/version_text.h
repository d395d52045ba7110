#pragma once

#include <string>

namespace carousel::app {

/// The text of `carousel --version`: version, commit, compiler, SIMD targets.
std::string version_text();

/// What `carousel --version --verbose` adds: each module with its file, what it brings and the library under it, or why
/// it cannot be opened. Opens them all.
std::string modules_text();

}  // namespace carousel::app
