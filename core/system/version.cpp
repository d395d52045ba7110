#include "core/system/version.h"

namespace carousel {

BuildInfo build_info() {
  BuildInfo info{CAROUSEL_VERSION, CAROUSEL_COMMIT, CAROUSEL_COMPILER, CAROUSEL_BUILD_TYPE};
#ifdef CAROUSEL_CHECKED
  info.checked = true;
#endif
  return info;
}

}  // namespace carousel
