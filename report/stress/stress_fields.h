#pragma once

#include "report/stress/stress.h"

namespace carousel::report {

// As report/run/report_fields.h, for `carousel stress`.

template <class V>
void describe(V& v, StressLatency& r) {
  v.field("p50", r.p50, "ns", "half of the messages took no longer");
  v.field("p99", r.p99, "ns", "99 of 100 took no longer");
  v.field("p99_9", r.p99_9, "ns", "999 of 1000 took no longer");
  v.field("max", r.max, "ns", "the longest");
}

template <class V>
void describe(V& v, StressRow& r) {
  v.field("queue", r.queue, "", "kind of queue");
  v.field("pattern", r.pattern, "", "what its threads did");
  v.field("message_bytes", r.message_bytes, "bytes", "of a message");
  v.field("capacity", r.capacity, "messages", "of a queue");
  v.field("threads", r.threads, "threads", "that took part");
  v.field("messages", r.messages, "messages", "sent in all repetitions");
  v.field("rate_median", r.rate_median, "messages/s", "median of the repetitions");
  v.field("rate_least", r.rate_least, "messages/s", "slowest repetition");
  v.field("rate_most", r.rate_most, "messages/s", "fastest repetition");
  v.section("transit", r.transit, "from the push that took a message to its pop");
  v.section("round_trip", r.round_trip, "until it is back where it came from");
  v.field("fairness", r.fairness, "fraction",
          "least over most sent by a producer when the first had sent its share; worst repetition");
  v.field("push_refused", r.push_refused, "fraction", "of the push calls");
  v.field("pop_refused", r.pop_refused, "fraction", "of the pop calls");
  v.field("blocked", r.blocked, "fraction", "back-pressure: of the producers' time, waiting for a place");
  v.field("memory_bytes", r.memory_bytes, "bytes", "heap of one queue that has been full");
  v.field("found", r.found, "", "what it did wrong: lost, doubled, reordered, torn, bounds, stuck; empty: nothing");
  v.field("detail", r.detail, "", "the first of these");
}

template <class V>
void describe(V& v, StressRingRow& r) {
  v.field("queue", r.queue, "", "kind of queue");
  v.field("depth", r.depth, "packets", "room of each link");
  v.field("rate_median", r.rate_median, "rays/s", "median of the repetitions");
  v.field("rate_least", r.rate_least, "rays/s", "slowest repetition");
  v.field("rate_most", r.rate_most, "rays/s", "fastest repetition");
  v.field("relative", r.relative, "fraction", "of the best one's median");
  v.field("refused", r.refused, "fraction", "of the packets offered to links");
  v.field("occupancy_mean", r.occupancy_mean, "packets", "waiting in a link, seen at every eighth send");
  v.field("same_digest", r.same_digest, "", "whether hits and image are those of the first");
}

template <class V>
void describe(V& v, Stress& r) {
  v.field("incomplete", r.incomplete, "", "whether it was interrupted");
  v.field("cores", r.cores, "cores", "of the machine");
  v.field("repetitions", r.repetitions, "", "of each row, in turn");
  v.field("seconds", r.seconds, "s", "taken");
  v.section("rows", r.rows, "queues by themselves");
  v.section("ring", r.ring, "queues inside the ring of the configuration");
  v.field("ring_verdict", r.ring_verdict, "", "what the choice of queue and depth makes of rays per second");
}

}  // namespace carousel::report
