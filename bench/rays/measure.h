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

/// A contestant's hits were not what they have to be.
class WrongHits : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Every contestant once for each number of threads, then all of them again, as often as asked for, so that
/// whatever else the machine does meets all alike; each round starts with another one. What takes longer than
/// a few seconds is run once only; what is given up is rated by the rays it traced. Every other run's hits
/// are compared with the depth-first tracer's: ours must be the same to the bit, Embree may disagree on
/// whether there is a hit for one ray in a thousand. Throws WrongHits.
SetResult measure(const std::vector<Contestant>& contestants, const accel::Accel& accel, const RaySet& rays,
                  const MeasureOptions& options);

}  // namespace carousel::bench
