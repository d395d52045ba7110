#pragma once

#include "ringbus/cycle/time/clock.h"

namespace carousel::ringbus::cycle {

/// To a resource with nothing to test: shade a ray, in so many cycles.
struct ShadeJob {
  Cycle cycles = 0;
};

/// A resource's testers have fallen idle or are needed again, or it has done its job.
struct HelpNote {
  bool shaded = false;  ///< the job is done
  bool idle = false;    ///< its testers have nothing to do now
};

}  // namespace carousel::ringbus::cycle
