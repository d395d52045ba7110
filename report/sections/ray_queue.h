#pragma once

#include <string>

#include "report/sections/visitor.h"

namespace carousel::report {

/// A queue of the native engine that hands rays over, or several of one design.
struct RayQueue {
  std::string kind;
  std::uint64_t depth = 0, sent = 0;
  double rays_at_once = 0;
  std::uint64_t refused = 0;
  double waiting_mean = 0;
  std::uint64_t waiting_max = 0;
};

template <class V>
void describe(V& v, const RayQueue& r) {
  v.field("kind", r.kind, "", "design of the queue");
  v.field("depth", r.depth, "pieces", "batches of completed rays, or groups of new ones, that a queue holds");
  v.field("sent", r.sent, "pieces", "batches or groups that went through");
  v.field("rays_at_once", r.rays_at_once, "rays", "rays in a batch or group, on average; a bundle counts as one");
  v.field("refused", r.refused, "times", "times that a batch or group found no place and waited");
  v.field("waiting_mean", r.waiting_mean, "pieces", "batches or groups in the queue when one came, itself included");
  v.field("waiting_max", r.waiting_max, "pieces", "the most of them");
}

/// Both ways between the resources and the shader workers.
struct RayQueues {
  RayQueue completed, created;
};

template <class V>
void describe(V& v, const RayQueues& r) {
  v.section("completed", r.completed, "queue of batches of completed rays to the shader workers");
  v.section("created", r.created, "queues of groups of new rays to the resources, all together");
}

}  // namespace carousel::report
