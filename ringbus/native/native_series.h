#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/config/config.h"
#include "ringbus/native/native_port.h"
#include "ringbus/native/shader_worker.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/results/time_series.h"

namespace carousel::ringbus {

/// The time series of a native run. The engine's watcher looks at counters that the workers write anyway, at times that
/// are not quite regular; a reading at a regular time lies on the line between the looks before and after it.
class NativeSeries {
 public:
  /// How often the watcher looks.
  static constexpr std::chrono::milliseconds kPollInterval{10};

  /// `wanted`: most samples; 0: nothing is kept.
  NativeSeries(std::size_t wanted, const Config& config);

  bool on() const { return samples_.on(); }
  using Ports = std::vector<std::unique_ptr<NativePort>>;  ///< by resource
  /// Notes the state of the machine. The numbers need not fit each other.
  void look(std::chrono::nanoseconds since_start, const RayCount& count, const RayControl& control, const Ports& ports);
  /// The ports will be made anew, and count from 0 again.
  void carry(const Ports& ports);
  /// After the last look.
  TimeSeries finish();

 private:
  std::size_t resources_, slots_;
  CounterSamples samples_;  // its times are microseconds
  // Counters at the last look and at the one before: levels are summed over microseconds.
  std::vector<std::uint64_t> last_, before_, levels_;
  std::vector<std::uint64_t> carried_;  // by resource: visits
  CounterSamples::Time last_at_ = 0, before_at_ = 0;
};

}  // namespace carousel::ringbus
