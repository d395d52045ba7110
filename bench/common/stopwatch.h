#pragma once

#include <vector>

namespace carousel::bench {

/// Wall time and the process's CPU time (user and system, all threads), in seconds.
struct Elapsed {
  double wall = 0;
  double cpu = 0;
};

class Stopwatch {
 public:
  Stopwatch() : start_(now()) {}
  Elapsed elapsed() const;

 private:
  static Elapsed now();
  Elapsed start_;
};

/// Median, least and greatest of repetitions.
struct Spread {
  double median = 0, min = 0, max = 0;
};

/// The spread of one value or more.
Spread spread_of(std::vector<double> values);

}  // namespace carousel::bench
