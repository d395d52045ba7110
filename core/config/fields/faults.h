#pragma once

#include <cstdint>

#include "core/config/fields/field.h"

namespace carousel {

/// Faults that happen on request. They are drawn from `seed`.
struct FaultsConfig {
  std::int64_t seed = 1;
  struct Links {
    double drop = 0, duplicate = 0, corrupt = 0, reorder = 0, delay = 0;
    std::int64_t delay_cycles = 100;
    bool any() const { return drop > 0 || duplicate > 0 || corrupt > 0 || reorder > 0 || delay > 0; }
  } links;
  struct Resource {
    enum class Kind { kNone, kPause, kSlow, kStop } kind = Kind::kNone;
    std::int64_t number = 0;
    std::int64_t after_rays = 0;
    std::int64_t cycles = 100'000;
    std::int64_t factor = 4;
    bool recover = true;
    std::int64_t silence_cycles = 10'000;
  } resource;
  bool compare = false;
  bool any() const { return links.any() || resource.kind != Resource::Kind::kNone; }
};

template <>
inline constexpr auto kEnumNames<FaultsConfig::Resource::Kind> = [] {
  using enum FaultsConfig::Resource::Kind;
  return names<FaultsConfig::Resource::Kind>({{kNone, "none"}, {kPause, "pause"}, {kSlow, "slow"}, {kStop, "stop"}});
}();

namespace config {

inline constexpr RealRange kFaultFraction{0, 0.9};  // some frames must get through

template <class V>
void describe(V& v, FaultsConfig::Links& c) {
  v.field("drop", c.drop, kFaultFraction, "fraction", "The part of the frames that is lost.");
  v.field("duplicate", c.duplicate, kFaultFraction, "fraction", "The part of the frames that arrives twice.");
  v.field("corrupt", c.corrupt, kFaultFraction, "fraction", "The part of the frames that has a bit flipped.");
  v.field("reorder", c.reorder, kFaultFraction, "fraction", "The part of the frames that arrives after the next one.");
  v.field("delay", c.delay, kFaultFraction, "fraction", "The part of the frames that arrives late.");
  v.field("delay_cycles", c.delay_cycles, kCycles, "cycles",
          "The time by which a frame is late. In the native engine a cycle is that of engine.clock_mhz.");
}

template <class V>
void describe(V& v, FaultsConfig::Resource& c) {
  v.choice("kind", c.kind, "The fault of a resource: it pauses once, is slow, stops for good, or has none.");
  v.field("number", c.number, IntRange{0, kMaxResources - 1}, "", "The number of the resource.");
  v.field("after_rays", c.after_rays, IntRange{0, 1'000'000'000}, "rays",
          "The fault begins when the resource has completed so many rays.");
  v.field("cycles", c.cycles, IntRange{1, 1'000'000'000}, "cycles",
          "The length of a pause. In the native engine a cycle is that of engine.clock_mhz.");
  v.field("factor", c.factor, IntRange{2, 1000}, "times", "A slow resource takes so many times as long for a step.");
  v.field("recover", c.recover, "",
          "After a stop the resource's unfinished rays start again elsewhere. Otherwise the run ends and names them.");
  v.field("silence_cycles", c.silence_cycles, IntRange{1, 1'000'000'000}, "cycles",
          "Ray control gives a resource up after so long without a sign of life. The native engine waits 100 ms.");
}

template <class V>
void describe(V& v, FaultsConfig& c) {
  v.field("seed", c.seed, kSeed, "", "The seed of the faults.");
  v.section("links", c.links, "Faults of links, which recover by sequence numbers, checksums and go-back-N.");
  v.section("resource", c.resource, "A fault of one resource.");
  v.field("compare", c.compare, "",
          "The cycle engine simulates once more without faults, and the report says what they cost.");
}

}  // namespace config
}  // namespace carousel
