#include "bench/common/stopwatch.h"

#include <algorithm>
#include <chrono>

#include <sys/resource.h>

namespace carousel::bench {

Elapsed Stopwatch::now() {
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {std::chrono::duration<double>(wall).count(), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

Elapsed Stopwatch::elapsed() const {
  const Elapsed end = now();
  return {end.wall - start_.wall, end.cpu - start_.cpu};
}

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

}  // namespace carousel::bench
