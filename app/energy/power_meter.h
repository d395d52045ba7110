#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "app/energy/energy_account.h"
#include "ringbus/results/time_series.h"

namespace carousel::app {

/// Joules by part over the time of a run, and the thousand cycles with the most of them.
class PowerMeter final : public ringbus::EnergyMeter {
 public:
  static constexpr std::uint64_t kWindow = 1000, kResolution = 100;  ///< cycles

  /// Keeps a reference to `config`. `link_mm`: length of a link between neighbours; `clock_mhz`: engine.clock_mhz.
  PowerMeter(const Config& config, double link_mm, std::int64_t clock_mhz)
      : config_(config), link_mm_(link_mm), clock_mhz_(clock_mhz) {}

  void begin(const std::vector<ByteRow>& rows, std::size_t most_samples) override;
  std::uint64_t next() const override { return std::min(next_sample_, next_slot_); }
  void read(const ringbus::EnergyEvents& events) override;
  void close(std::uint64_t cycles, const ringbus::EnergyEvents& events) override;

  // After close().

  /// Adds a row for each part. The length of a sample is a power of two, and no less than that of this meter's.
  void add_rows(ringbus::TimeSeries& series) const;
  /// Absent of a run of fewer cycles.
  std::optional<report::PowerPeak> peak() const;

 private:
  using Joules = std::array<double, report::EnergyParts::kParts>;
  Joules joules(const ringbus::EnergyEvents& events) const;
  void halve();
  void end_slot(const Joules& now);

  const Config& config_;
  double link_mm_;
  std::int64_t clock_mhz_;
  std::optional<EnergyAccount> account_;
  // Readings at multiples of a sample's length, of which every other one is dropped when there are too many: twice as
  // many as the series has, since a look in the last window may come after the last cycle of the run.
  std::size_t most_ = 0;
  std::uint64_t interval_ = 1, next_sample_ = 1, next_slot_ = kResolution;
  std::vector<Joules> readings_;
  Joules last_{};
  // The readings at the last multiples of the resolution.
  std::deque<Joules> slots_{Joules{}};
  struct Peak {
    double joules = -1;
    std::uint64_t first_cycle = 0;
    Joules parts{};
  } peak_;
  double most_around_ = 0;  // joules of the window and one resolution more
};

}  // namespace carousel::app
