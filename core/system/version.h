#pragma once

#include <string>

namespace carousel {

/// The commit and compiler of this program, read when cmake configures.
struct BuildInfo {
  std::string version, commit, compiler, build_type;
  bool checked = false;  ///< CAROUSEL_CHECKED
};

BuildInfo build_info();

}  // namespace carousel
