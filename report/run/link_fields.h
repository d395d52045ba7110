#pragma once

#include "report/run/report.h"

namespace carousel::report {

// As report/run/report_fields.h, for the sections `links`.

template <class V>
void describe(V& v, LinkCycles& r) {
  v.field("busy", r.busy, "cycles", "moving a packet");
  v.field("stalled", r.stalled, "cycles", "a packet waited for a place at the other end");
  v.field("idle", r.idle, "cycles", "nothing to move");
}

template <class V>
void describe(V& v, LinkOccupancy& r) {
  v.field("seconds", r.seconds, "s", "since the start, at the end of this part");
  v.field("mean", r.mean, "packets", "waiting, seen at every eighth send");
  v.field("most", r.most, "packets", "waiting, seen at every eighth send");
}

template <class V>
void describe(V& v, LinkFaults& r) {
  v.field("dropped", r.dropped, "frames", "lost on the way");
  v.field("duplicated", r.duplicated, "frames", "that came twice");
  v.field("corrupted", r.corrupted, "frames", "with a bit flipped");
  v.field("reordered", r.reordered, "frames", "that came after the next one");
  v.field("delayed", r.delayed, "frames", "that came later");
  v.field("resent", r.resent, "frames", "sent again");
  v.field("discarded", r.discarded, "frames", "that the receiver had no use for");
}

template <class V>
void describe(V& v, Link& r) {
  v.field("from", r.from, "", "resource that sends");
  v.field("to", r.to, "", "resource that receives");
  v.field("depth", r.depth, "packets", "room of the queue");
  v.field("packets", r.packets, "packets", "carried");
  v.field("occupancy_mean", r.occupancy_mean, "packets",
          "waiting: seen at every eighth send (native), over time (cycle)");
  v.field("occupancy_max", r.occupancy_max, "packets",
          "waiting: seen at every eighth send and at refusals (native), ever (cycle)");
  v.field("stalled", r.stalled, "attempts|cycles",
          "sends that found the queue full (native), cycles in which a packet waited for a credit (cycle)");
  v.field("utilisation", r.utilisation, "fraction", "cycles in which it moved something, over all");
  v.section("cycles", r.cycles, "they add up to engine.cycles");
  v.field("queue", r.queue, "", "kind of queue (native)");
  v.field("sent_at_once", r.sent_at_once, "packets", "mean of the sends that took any (native)");
  v.field("received_at_once", r.received_at_once, "packets", "mean of the receptions that brought any (native)");
  v.field("full_stalls", r.full_stalls, "sends", "that the queue did not take all of (native)");
  v.field("empty_stalls", r.empty_stalls, "receptions", "that found nothing (native)");
  v.section("occupancy", r.occupancy, "over time: equal numbers of samples (native)");
  v.section("faults", r.faults, "where there are faults: what happened to frames and acknowledgements");
}

}  // namespace carousel::report
