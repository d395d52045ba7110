#include "app/host/version_text.h"

#include <fmt/format.h>

#include "accel/traverse/kernels.h"
#include "core/module/module.h"
#include "core/system/version.h"

namespace carousel::app {

std::string version_text() {
  const BuildInfo build = build_info();
  return fmt::format("carousel {}\ncommit {}\ncompiler {}, {}{}\nSIMD targets {}", build.version, build.commit,
                     build.compiler, build.build_type.empty() ? "no build type" : build.build_type,
                     build.checked ? ", checked" : "", fmt::join(accel::simd_targets(), ", "));
}

std::string modules_text() {
  std::string out = fmt::format("modules in {}", module_folder().string());
  for (const FoundModule& found : find_modules()) {
    out += fmt::format("\n  {:<10}", found.name);
    if (!found.file.empty()) out += found.file.filename().string() + ", ";
    out += found.info == nullptr ? (found.file.empty() ? found.refused : "refused: " + found.refused)
                                 : fmt::format("{}: {}", found.info->library(), found.info->brings);
  }
  return out;
}

}  // namespace carousel::app
