#include "app/host/program_info.h"

#include "core/system/version.h"

namespace carousel::app {

report::Program program_info() {
  const BuildInfo build = build_info();
  return {build.version, build.commit, build.compiler, build.build_type, build.checked};
}

}  // namespace carousel::app
