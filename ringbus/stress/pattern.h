#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace carousel::ringbus::stress {

enum class Pattern {
  kStream,           ///< one producer, one consumer, a message a call
  kBatches,          ///< one producer, one consumer, 32 messages a call
  kBurst,            ///< 32 messages at once, then a pause
  kPingPong,         ///< one message to and fro
  kCirculation,      ///< a ring of four: each message visits every node and returns
  kHotspot,          ///< four producers, one consumer
  kManyToMany,       ///< two producers, two consumers, one queue
  kSlowConsumer,     ///< a pause after every message taken
  kStalledConsumer,  ///< the consumer stops now and then for milliseconds
  kOversubscribed,   ///< more threads than cores
  kCapacity1,
  kCapacity2,
  kRandomPauses,  ///< both sides yield and sleep at random; batches of random length
};

struct PatternName {
  Pattern pattern;
  std::string_view name;
};
inline constexpr std::array kPatterns{
    PatternName{Pattern::kStream, "stream"},
    PatternName{Pattern::kBatches, "batches"},
    PatternName{Pattern::kBurst, "burst"},
    PatternName{Pattern::kPingPong, "ping_pong"},
    PatternName{Pattern::kCirculation, "circulation"},
    PatternName{Pattern::kHotspot, "hotspot"},
    PatternName{Pattern::kManyToMany, "many_to_many"},
    PatternName{Pattern::kSlowConsumer, "slow_consumer"},
    PatternName{Pattern::kStalledConsumer, "stalled_consumer"},
    PatternName{Pattern::kOversubscribed, "oversubscribed"},
    PatternName{Pattern::kCapacity1, "capacity_1"},
    PatternName{Pattern::kCapacity2, "capacity_2"},
    PatternName{Pattern::kRandomPauses, "random_pauses"},
};

constexpr std::string_view pattern_name(Pattern pattern) {
  for (const PatternName& entry : kPatterns)
    if (entry.pattern == pattern) return entry.name;
  return {};
}

}  // namespace carousel::ringbus::stress
