#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// Digests of every step of a run, one for each stretch of equal length.
struct Epochs {
  std::uint64_t cycles_each = 0;
  std::vector<std::string> digests;
};

template <class V>
void describe(V& v, const Epochs& r) {
  v.field("cycles_each", r.cycles_each, "cycles", "length of an epoch");
  v.field("digests", r.digests, "", "64 bits for each epoch over every step in it");
}

/// A clock of a machine that has several.
struct ClockUse {
  std::string name;
  std::int64_t mhz = 0;
  std::uint64_t cycles = 0;
};

template <class V>
void describe(V& v, const ClockUse& r) {
  v.field("name", r.name, "", "as clocks and topology have it; core is that of the resources");
  v.field("mhz", r.mhz, "MHz", "its frequency");
  v.field("cycles", r.cycles, "cycles", "its cycles in the run");
}

struct Engine {
  std::string kind;
  std::optional<std::uint64_t> cycles{};
  std::optional<double> nanoseconds{};
  std::optional<Epochs> epochs{};
  bool deterministic = false;
  std::string reason;
};

template <class V>
void describe(V& v, const Engine& r) {
  v.field("kind", r.kind, "", "native or cycle");
  v.field("cycles", r.cycles, "cycles", "simulated cycles until everything had come to rest");
  v.field("nanoseconds", r.nanoseconds, "ns", "the same at engine.clock_mhz, where there are several clocks");
  v.section("epochs", r.epochs, "digests that locate the first difference of two runs; see carousel compare");
  v.field("deterministic", r.deterministic, "", "true if everything outside of host is the same in every run");
  v.field("reason", r.reason, "", "reason for the value of deterministic");
}

/// Something that costs the simulated machine nothing in this run.
struct Charge {
  std::string name, meaning;
  std::optional<std::string> key{}, set{};
};

template <class V>
void describe(V& v, const Charge& r) {
  v.field("name", r.name, "", "what is not charged");
  v.field("meaning", r.meaning, "", "the same in words");
  v.field("key", r.key, "", "key that charges it; absent if none does");
  v.field("set", r.set, "", "value of --set that charges it, as carousel run --charge-all does");
}

}  // namespace carousel::report
