#pragma once

#include <cstdint>

namespace carousel::ringbus {

/// What a link's ends saw of it; read when the engine has stopped.
struct LinkStatistics {
  // The sender's.
  std::uint64_t packets = 0;        ///< sent
  std::uint64_t refusals = 0;       ///< sends the full queue refused, in packets and attempts
  std::uint64_t batches = 0;        ///< sends that took any packet
  std::uint64_t full_stalls = 0;    ///< sends that did not take all
  std::uint64_t occupancy_max = 0;  ///< packets waiting, seen at samples and refusals
  std::uint64_t occupancy_sum = 0;  ///< over `samples`
  std::uint64_t samples = 0;        ///< one in Link::kSendsASample sends, the first among them
  // The receiver's.
  std::uint64_t receives = 0;      ///< calls that brought any packet
  std::uint64_t empty_stalls = 0;  ///< calls that brought none
};

}  // namespace carousel::ringbus
