#pragma once

#include <algorithm>
#include <cstdint>

namespace carousel {

/// Counts the traffic of a queue that hands rays over in pieces, batches or groups; or of several queues of one design.
struct QueueUse {
  std::uint64_t places = 0;        ///< pieces that one queue holds at most
  std::uint64_t sent = 0;          ///< pieces that a producer put in
  std::uint64_t rays = 0;          ///< in them
  std::uint64_t refusals = 0;      ///< times a producer found no free place
  std::uint64_t waiting_sum = 0;   ///< pieces inside when one came, itself included, summed over `sent`
  std::uint64_t waiting_most = 0;  ///< and the most

  QueueUse& operator+=(const QueueUse& o) {
    places = std::max(places, o.places);
    sent += o.sent;
    rays += o.rays;
    refusals += o.refusals;
    waiting_sum += o.waiting_sum;
    waiting_most = std::max(waiting_most, o.waiting_most);
    return *this;
  }
};

}  // namespace carousel
