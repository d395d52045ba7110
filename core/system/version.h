#pragma once

#include <string>

namespace carousel {

/// What this program was built from, fixed when cmake configured.
struct BuildInfo {
  std::string version, commit, compiler, build_type;
  bool checked = false;  ///< CAROUSEL_CHECKED
};

BuildInfo build_info();

}  // namespace carousel
