#include "app/host/version_text.h"

#include <fmt/format.h>

#include "accel/traverse/kernels.h"
#include "core/system/version.h"

namespace carousel::app {

std::string version_text() {
  const BuildInfo build = build_info();
  return fmt::format("carousel {}\ncommit {}\ncompiler {}, {}{}\nSIMD targets {}", build.version, build.commit,
                     build.compiler, build.build_type.empty() ? "no build type" : build.build_type,
                     build.checked ? ", checked" : "", fmt::join(accel::simd_targets(), ", "));
}

}  // namespace carousel::app
