#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/common/results.h"
#include "bench/rays/contestants.h"

namespace carousel::bench {

struct MeasureOptions {
  int repetitions = 5;
  std::vector<int> threads{1, 2};
  std::function<void(const std::string&)> progress;  ///< may be empty
};

/// Thrown if a contestant's hits are wrong.
class WrongHits : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs every contestant once for each number of threads, then all of them again, `repetitions` times, so that other
/// load of the machine affects all alike; each round starts with another contestant. A run longer than a few seconds is
/// not repeated; a run that is stopped early is rated by the rays it traced. The hits of every other run are compared
/// with the depth-first tracer's: Carousel's must be the same to the bit, Embree may find a hit or a miss differently
/// for one ray in a thousand. Throws WrongHits.
SetResult measure(const std::vector<Contestant>& contestants, const accel::Accel& accel, const RaySet& rays,
                  const MeasureOptions& options);

}  // namespace carousel::bench
