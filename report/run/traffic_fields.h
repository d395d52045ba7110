#pragma once

#include "report/run/traffic.h"

namespace carousel::report {

// As report/run/report_fields.h, for the section `traffic`.

template <class V>
void describe(V& v, Latency& r) {
  v.field("mean", r.mean, "cycles", "from creation to delivery of the last flit");
  v.field("p50", r.p50, "cycles", "half of the packets took no longer");
  v.field("p95", r.p95, "cycles", "19 of 20 packets took no longer");
  v.field("p99", r.p99, "cycles", "99 of 100 packets took no longer");
  v.field("max", r.max, "cycles", "the longest");
}

template <class V>
void describe(V& v, LinkUse& r) {
  v.field("mean", r.mean, "fraction", "of all links, over the whole run");
  v.field("max", r.max, "fraction", "of the busiest link");
}

template <class V>
void describe(V& v, Traffic& r) {
  v.field("packets", r.packets, "packets", "created");
  v.field("delivered", r.delivered, "packets", "of these; all in a complete run");
  v.field("flits_per_packet", r.flits_per_packet, "flits", "cycles for which a packet occupies a link");
  v.field("window_begin", r.window_begin, "cycle", "first in which what is created and delivered is measured");
  v.field("window_end", r.window_end, "cycle", "the one after the last in which packets were created");
  v.field("measured", r.measured, "packets", "created within the window");
  v.field("offered", r.offered, "packets/resource/cycle", "created within the window");
  v.field("accepted", r.accepted, "packets/resource/cycle",
          "delivered within the window; less than offered: saturated");
  v.field("routers_mean", r.routers_mean, "resources", "visited by a measured packet, the first and the last included");
  v.field("zero_load_latency", r.zero_load_latency, "cycles", "mean of the measured packets if each were alone");
  v.section("latency", r.latency, "of the measured packets");
  v.section("link_utilisation", r.link_utilisation, "cycles in which a link moved something, over all");
  v.field("flit_hops", r.flit_hops, "flits", "over all links");
}

}  // namespace carousel::report
