#pragma once

#include <cstdint>
#include <optional>

#include "report/sections/latency.h"

namespace carousel::report {

struct LinkUse {
  double mean = 0, max = 0;
};

template <class V>
void describe(V& v, const LinkUse& r) {
  v.field("mean", r.mean, "fraction", "mean of all links");
  v.field("max", r.max, "fraction", "utilisation of the busiest link");
}

/// What the stops of a ring without queues have done, by the clock of the network.
struct RingStopsUse {
  std::uint64_t extra_rounds = 0, longest_ride = 0, longest_wait = 0, reservations = 0, starts = 0;
};

template <class V>
void describe(V& v, const RingStopsUse& r) {
  v.field("extra_rounds", r.extra_rounds, "flits",
          "flits that found the port of their stop busy, or no place behind it, and went round again");
  v.field("longest_ride", r.longest_ride, "cycles", "longest time from a flit's getting on until it got off");
  v.field("longest_wait", r.longest_wait, "cycles",
          "longest time that a packet, or a flit of it, that was the first at its stop waited to get on");
  v.field("reservations", r.reservations, "reservations",
          "slots or grants that stops reserved after fair_after_cycles");
  v.field("starts", r.starts, "packets", "packets that got on, answers included");
}

/// A run of synthetic traffic (workload: {traffic: ...}).
struct Traffic {
  std::uint64_t packets = 0, delivered = 0, flits_per_packet = 0;
  std::uint64_t window_begin = 0, window_end = 0;
  std::uint64_t measured = 0;
  double offered = 0, accepted = 0;
  double routers_mean = 0, zero_load_latency = 0;
  Latency latency;
  LinkUse link_utilisation;
  std::uint64_t flit_hops = 0;
  double accepted_of_links = 0, gigabytes_per_second = 0;
  std::uint64_t least_latency = 0;
  std::optional<double> mean_nanoseconds{};
  std::optional<RingStopsUse> stops;
};

template <class V>
void describe(V& v, const Traffic& r) {
  v.field("packets", r.packets, "packets", "packets created");
  v.field("delivered", r.delivered, "packets", "packets delivered; equal to packets in a complete run");
  v.field("flits_per_packet", r.flits_per_packet, "flits", "flits of a packet: cycles for which it occupies a link");
  v.field("window_begin", r.window_begin, "cycle", "first cycle of the window of measurement");
  v.field("window_end", r.window_end, "cycle", "cycle after the last one in which packets were created");
  v.field("measured", r.measured, "packets", "packets created within the window");
  v.field("offered", r.offered, "packets/resource/cycle", "load of the packets created within the window");
  v.field("accepted", r.accepted, "packets/resource/cycle",
          "load of the packets delivered within the window; less than offered in a saturated network");
  v.field("gigabytes_per_second", r.gigabytes_per_second, "GB/s",
          "bytes of the packets accepted, answers included, at engine.clock_mhz");
  v.field("accepted_of_links", r.accepted_of_links, "fraction",
          "part of what all links could move within the window that the packets delivered in it needed");
  v.field("routers_mean", r.routers_mean, "resources",
          "resources that a measured packet visited, the first and the last included");
  v.field("zero_load_latency", r.zero_load_latency, "cycles",
          "mean latency of the measured packets if each were alone");
  v.section("latency", r.latency, "latency of the measured packets, from creation to delivery of the last flit");
  v.field("mean_nanoseconds", r.mean_nanoseconds, "ns", "mean latency as a time, where there are several clocks");
  v.field("least_latency", r.least_latency, "cycles",
          "the least of these latencies; from 2048 cycles on, the least of its class");
  v.section("link_utilisation", r.link_utilisation,
            "fraction of the cycles of the window in which a link moved a flit");
  v.field("flit_hops", r.flit_hops, "flits", "flits moved within the window, summed over all links");
  v.section("stops", r.stops, "of a ring whose stops have no queues");
}

}  // namespace carousel::report
