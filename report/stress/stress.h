#pragma once

#include "report/schema/checksum.h"
#include "report/schema/document_version.h"
#include "report/sections/visitor.h"

namespace carousel::report {

struct StressLatency {
  double p50 = 0, p99 = 0, p99_9 = 0, max = 0;
};

template <class V>
void describe(V& v, const StressLatency& r) {
  v.field("p50", r.p50, "ns", "median latency");
  v.field("p99", r.p99, "ns", "latency that 99 of 100 messages did not exceed");
  v.field("p99_9", r.p99_9, "ns", "latency that 999 of 1000 messages did not exceed");
  v.field("max", r.max, "ns", "greatest latency");
}

/// A queue under a pattern, over all repetitions.
struct StressRow {
  std::string queue, pattern;
  std::uint64_t message_bytes = 0, capacity = 0, threads = 0, messages = 0;
  double rate_median = 0, rate_least = 0, rate_most = 0;
  std::optional<StressLatency> transit, round_trip;
  double fairness = 1;
  double push_refused = 0, pop_refused = 0, blocked = 0;
  std::uint64_t memory_bytes = 0;
  std::string found, detail;
  std::string expected;
};

template <class V>
void describe(V& v, const StressRow& r) {
  v.field("queue", r.queue, "", "kind of queue");
  v.field("pattern", r.pattern, "", "pattern of the queue's threads");
  v.field("message_bytes", r.message_bytes, "bytes", "size of a message");
  v.field("capacity", r.capacity, "messages", "capacity of a queue");
  v.field("threads", r.threads, "threads", "threads that took part");
  v.field("messages", r.messages, "messages", "messages sent in all repetitions");
  v.field("rate_median", r.rate_median, "messages/s", "median rate of the repetitions");
  v.field("rate_least", r.rate_least, "messages/s", "rate of the slowest repetition");
  v.field("rate_most", r.rate_most, "messages/s", "rate of the fastest repetition");
  v.section("transit", r.transit, "time from the push that took a message to its pop");
  v.section("round_trip", r.round_trip, "time until a message is back where it came from");
  v.field("fairness", r.fairness, "fraction",
          "least over most sent by a producer when the first had sent its share; worst repetition");
  v.field("push_refused", r.push_refused, "fraction", "fraction of push calls that were refused");
  v.field("pop_refused", r.pop_refused, "fraction", "fraction of pop calls that were refused");
  v.field("blocked", r.blocked, "fraction",
          "back-pressure: fraction of the producers' time in which they waited for a place");
  v.field("memory_bytes", r.memory_bytes, "bytes", "heap of one queue that has been full");
  v.field("found", r.found, "",
          "faults of the queue: lost, doubled, reordered, torn, bounds, stuck; empty if there was none");
  v.field("detail", r.detail, "", "the first fault found");
  v.field("expected", r.expected, "",
          "property of the design that explains all faults found, which then are none of the run; else empty");
}

/// A queue of a depth inside the ring of a configuration.
struct StressRingRow {
  std::string queue;
  std::uint64_t depth = 0;
  double rate_median = 0, rate_least = 0, rate_most = 0;
  double relative = 0;
  double refused = 0;
  double occupancy_mean = 0;
  bool same_digest = true;
};

template <class V>
void describe(V& v, const StressRingRow& r) {
  v.field("queue", r.queue, "", "kind of queue");
  v.field("depth", r.depth, "pieces", "packets, batches or groups that each of the queues holds");
  v.field("rate_median", r.rate_median, "rays/s", "median rate of the repetitions");
  v.field("rate_least", r.rate_least, "rays/s", "rate of the slowest repetition");
  v.field("rate_most", r.rate_most, "rays/s", "rate of the fastest repetition");
  v.field("relative", r.relative, "fraction", "median rate over that of the best queue and depth");
  v.field("refused", r.refused, "fraction", "fraction of the packets, batches or groups offered that were refused");
  v.field("occupancy_mean", r.occupancy_mean, "pieces",
          "mean of those that wait in a queue when one comes; in links, at every eighth send");
  v.field("same_digest", r.same_digest, "", "true if hits and picture are those of the first row");
}

/// A queue of a depth, of those tried inside the ring.
struct StressRingChoice {
  std::string queue;
  std::uint64_t depth = 0;
};

template <class V>
void describe(V& v, const StressRingChoice& r) {
  v.field("queue", r.queue, "", "kind of queue");
  v.field("depth", r.depth, "pieces", "packets, batches or groups that each of the queues holds");
}

/// Pairs of runs of the best and the worst choice of one depth by the medians.
struct StressPairs {
  StressRingChoice first, second;
  std::uint64_t pairs = 0, wins = 0;
  double ratio = 1;
  std::optional<double> ratio_least{}, ratio_most{};
  bool difference = false;
};

template <class V>
void describe(V& v, const StressPairs& r) {
  v.section("first", r.first, "the choice with the highest median rate");
  v.section("second", r.second,
            "the choice with the lowest median rate of those of the same depth, or of all depths where one design was "
            "tried");
  v.field("pairs", r.pairs, "pairs", "pairs of runs made after the two had been chosen, each first in every other one");
  v.field("wins", r.wins, "pairs", "pairs in which `first` traced more rays per second");
  v.field("ratio", r.ratio, "", "median over the pairs of the rate of `first` over that of `second`");
  v.field("ratio_least", r.ratio_least, "",
          "lower end of the 99 % interval of the median; absent with fewer than 8 pairs");
  v.field("ratio_most", r.ratio_most, "", "upper end of the 99 % interval of the median");
  v.field("difference", r.difference, "",
          "true if the interval does not contain 1, so that the pairs show a difference");
}

/// The report of `carousel stress`.
struct Stress {
  std::int64_t schema_version = kDocumentVersion;
  bool incomplete = false;
  std::uint64_t cores = 0, repetitions = 0;
  double seconds = 0;
  std::vector<StressRow> rows;
  std::string ring_key;
  std::vector<StressRingRow> ring;
  std::optional<StressPairs> ring_pairs;
  std::string ring_verdict;
  std::optional<std::string> checksum{};  ///< set where the text is written (report/read/document.h)

  bool broken() const {
    for (const StressRow& row : rows)
      if (!row.found.empty() && row.expected.empty()) return true;
    for (const StressRingRow& row : ring)
      if (!row.same_digest) return true;
    return false;
  }
};

template <class V>
void describe(V& v, const Stress& r) {
  v.field("schema_version", r.schema_version, "", "version of these keys");
  v.field("incomplete", r.incomplete, "", "true if the run was interrupted");
  v.field("cores", r.cores, "cores", "hardware threads of the machine");
  v.field("repetitions", r.repetitions, "", "repetitions of each row, in turn");
  v.field("seconds", r.seconds, "s", "time of the whole run");
  v.section("rows", r.rows, "queues by themselves");
  v.field("ring_key", r.ring_key, "", "key of the queue in the ring that was tried; empty without a configuration");
  v.section("ring", r.ring, "queues inside the ring of the configuration");
  v.section("ring_pairs", r.ring_pairs,
            "the best choice of queue and depth against the worst of its depth, in pairs of runs");
  v.field("ring_verdict", r.ring_verdict, "", "the difference that the pairs show, in words; empty without pairs");
  v.field("checksum", r.checksum, "", kChecksumMeaning);
}

}  // namespace carousel::report
