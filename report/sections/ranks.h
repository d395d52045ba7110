#pragma once

#include "core/statistics/rank_counts.h"
#include "core/statistics/rank_memory.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// A process of a run with `engine.transport: mpi`.
struct Rank {
  std::uint64_t rank = 0, first_resource = 0, resources = 0, threads = 0, rays_shaded = 0;
  double waiting = 0;
  RankMemory memory{};
};

template <class V>
void describe(V& v, const Rank& r) {
  v.field("rank", r.rank, "", "number of the rank");
  v.field("first_resource", r.first_resource, "", "first resource of its arc");
  v.field("resources", r.resources, "resources", "resources that it plays");
  v.field("threads", r.threads, "threads", "threads that play them");
  v.field("rays_shaded", r.rays_shaded, "rays", "rays of the paths that it owns");
  v.field("waiting", r.waiting, "fraction",
          "part of the time of its threads in which nothing could be done at its resources, and nothing came");
  describe(v, r.memory);
}

/// The traffic from one rank to another.
struct RankLink {
  std::uint64_t from = 0, to = 0;
  RankCounts sent;
  double packets_per_message = 0, held = 0;
  std::uint64_t full = 0;
};

template <class V>
void describe(V& v, const RankLink& r) {
  v.field("from", r.from, "", "rank that sends");
  v.field("to", r.to, "", "rank that receives");
  v.field("packets_per_message", r.packets_per_message, "packets", "packets over messages");
  v.field("held", r.held, "fraction",
          "part of the run in which something to send waited for earlier messages to leave");
  v.field("full", r.full, "times",
          "back-pressure: sends of resources for which a link between the two ranks had too few places left");
  describe(v, r.sent);
}

}  // namespace carousel::report
