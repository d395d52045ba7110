#pragma once

#include <cstdint>

namespace carousel::ringbus {

/// Counts of the two ends of a link, read when the engine has stopped.
struct LinkStatistics {
  // Counted by the sender.
  std::uint64_t packets = 0;        ///< packets sent
  std::uint64_t refusals = 0;       ///< packets refused by the full queue, once for each attempt
  std::uint64_t batches = 0;        ///< sends of which the queue took any packet
  std::uint64_t full_stalls = 0;    ///< sends of which the queue did not take all packets
  std::uint64_t occupancy_max = 0;  ///< most packets waiting, at samples and refusals
  std::uint64_t occupancy_sum = 0;  ///< packets waiting, summed over `samples`
  std::uint64_t samples = 0;        ///< one in Link::kSendsASample sends, the first included
  // Counted by the receiver.
  std::uint64_t receives = 0;      ///< receptions that brought any packet
  std::uint64_t empty_stalls = 0;  ///< receptions that brought none
};

}  // namespace carousel::ringbus
