#pragma once

#include "core/statistics/collection_counts.h"
#include "core/statistics/resource_counts.h"
#include "report/sections/latency.h"

namespace carousel::report {

struct Packets {
  ResourceCounts counts;  ///< of all resources
  std::optional<Latency> latency{};

  double rays_mean() const { return ratio(counts.packet_rays, counts.packets_issued); }
  double local_fraction() const { return ratio(counts.local_rays, counts.seen_rays); }
  double bubble_fraction() const { return ratio(counts.bubbles, counts.visits); }
};

template <class V>
void describe(V& v, const Packets& r) {
  v.field("issued", r.counts.packets_issued, "packets", "packets issued from their owner's collections");
  v.field("retired", r.counts.packets_retired, "packets",
          "packets retired at their owner; equal to issued in a complete run");
  v.field("hops", r.counts.hops, "hops", "links crossed by packets");
  v.field("rays_mean", r.rays_mean(), "rays", "members of an issued packet");
  v.field("local_fraction", r.local_fraction(), "",
          "fraction of the members of a visiting packet whose records are at the resource visited");
  v.field("bubble_fraction", r.bubble_fraction(), "", "fraction of idle visits: visits of packets without a local ray");
  v.section("latency", r.latency, "time of a packet from the issue queue until it retires at its owner");
}

struct Collections {
  CollectionCounts counts;  ///< of all resources
  double fullness_mean = 0;
};

template <class V>
void describe(V& v, const Collections& r) {
  v.field("created", r.counts.created, "collections", "collections created in all");
  v.field("peak", r.counts.peak, "collections", "sum of each resource's most collections at one time");
  v.field("fullness_mean", r.fullness_mean, "", "rays of an issued packet over packets.rays");
  v.field("memberships_peak", r.counts.memberships_peak, "ray IDs",
          "sum of each resource's most ray IDs in collections at one time");
  v.field("spilled", r.counts.spilled, "ray IDs", "ray IDs stored in blocks beyond the capacity");
}

}  // namespace carousel::report
