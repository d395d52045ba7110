#pragma once

#include "core/types/ray.h"
#include "ringbus/time/channel_list.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// To a resource with nothing to test: shade a ray, in so many cycles.
struct ShadeJob {
  Cycle cycles = 0;

  std::uint64_t bytes() const { return sizeof(RayRecord); }
};

/// A resource's testers have fallen idle or are needed again, or it has done its job.
struct HelpNote {
  bool shaded = false;  ///< the job is done
  bool idle = false;    ///< its testers have nothing to do now

  /// A job's result, light and a new ray, is as large as a record.
  std::uint64_t bytes() const { return shaded ? 4 + sizeof(RayRecord) : 4; }
};

struct HelpKinds {
  MessageKind jobs, notes;
  /// `width` of the wires in bytes a cycle.
  HelpKinds(ChannelList& list, std::uint64_t width)
      : jobs(list.carry({"shading jobs", "shading", "resources", "wires of jobs", width})),
        notes(list.carry({"notes and results", "resources", "shading", "wires of notes", width})) {}
};

}  // namespace carousel::ringbus::cycle
