#pragma once

#include "ringbus/cycle/time/clock.h"

namespace carousel::ringbus::cycle {

/// To a resource with nothing to test: shade a ray, in so many cycles.
struct ShadeJob {
  Cycle cycles = 0;
};

/// From a resource whose testers fell idle or are needed again, or which has done its job.
struct HelpNote {
  bool shaded = false;  ///< the job is done
  bool idle = false;    ///< and this is how things stand
};

}  // namespace carousel::ringbus::cycle
