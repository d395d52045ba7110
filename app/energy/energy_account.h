#pragma once

#include <vector>

#include "core/costs/costs.h"
#include "core/statistics/byte_row.h"
#include "report/run/report.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/results/energy_events.h"

namespace carousel {
struct Config;
}

namespace carousel::app {

/// The events of a run, or of a part of it, as joules by part of one machine.
class EnergyAccount {
 public:
  /// `link_mm`: length of a link between neighbours. `rows`: of the machine's byte ledger, whose counts are not looked
  /// at. Keeps a reference to `config`.
  EnergyAccount(const Config& config, double link_mm, std::vector<ByteRow> rows);

  /// The memory moves `memory_times` the bytes of the events, and activates so many times their rows.
  report::EnergyParts parts(const ringbus::EnergyEvents& events, double memory_times = 1) const;

 private:
  class Sum;
  /// Picojoules of what units do beside their tests.
  struct WorkPrices {
    double refined, exact_volume, transform_in_double, inversion, full_inversion, inversion_in_double;
  };
  static WorkPrices work_prices(const Config& config);

  const Config& c_;
  ringbus::ParcelPlan drawn_;
  double link_mm_;
  Costs costs_;
  WorkPrices work_;
  std::vector<ByteRow> rows_;
  std::vector<double> wire_mm_;  // by link
  double rays_kib_, collections_kib_, buffer_kib_, l1_kib_, l2_kib_;
  double programs_kib_;  // the store behind the instruction caches of shader workers
};

/// What its report says of the events of a whole run.
ringbus::EnergyEvents energy_events(const report::Report& r);

/// The sum of all parts.
double joules_of(const report::EnergyParts& parts);

}  // namespace carousel::app
