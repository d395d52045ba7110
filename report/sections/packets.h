#pragma once

#include "core/statistics/collection_counts.h"
#include "core/statistics/packet_kind_counts.h"
#include "core/statistics/resource_counts.h"
#include "report/sections/distribution.h"
#include "report/sections/latency.h"

namespace carousel::report {

struct Packets {
  ResourceCounts counts;  ///< summed over all resources
  std::optional<PacketKindCounts> sent{};
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
  v.section("sent", r.sent,
            "packets and messages that left a resource in which dispatch has read them, by the kind that their header "
            "names (cycle)");
  v.section("latency", r.latency, "time of a packet from the issue queue until it retires at its owner");
}

struct Collections {
  CollectionCounts counts;  ///< summed over all resources; peaks are the greatest of any
  double fullness_mean = 0;
  std::optional<std::uint64_t> ids_at_once{}, ids_interval{};
  std::optional<SpillBytes> spill{};  ///< summed over all resources
  std::optional<Distribution> age{};
};

template <class V>
void describe(V& v, const Collections& r) {
  v.field("created", r.counts.created, "collections", "collections created in all");
  v.field("peak", r.counts.peak, "collections", "most collections that any one resource had at one time");
  v.field("fullness_mean", r.fullness_mean, "", "rays of an issued packet over packets.rays");
  v.field("memberships_peak", r.counts.memberships_peak, "ray IDs",
          "most ray IDs that any one resource had in collections at one time");
  v.field("ids_at_once", r.ids_at_once, "ray IDs",
          "most ray IDs in the collections of all resources together, looked at in one of every ids_interval cycles");
  v.field("ids_interval", r.ids_interval, "cycles", "cycles from one look at all collections to the next");
  v.field("spilled", r.counts.spilled, "ray IDs", "ray IDs stored in blocks beyond the capacity");
  describe_if_any(v, r.spill);
  v.section("age", r.age,
            "time that a collection had waited when a packet was taken from it, since its first ray came or the last "
            "packet was taken (cycle)");
}

}  // namespace carousel::report
