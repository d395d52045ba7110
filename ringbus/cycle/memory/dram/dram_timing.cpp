#include "ringbus/cycle/memory/dram/dram_timing.h"

#include "core/system/error.h"

namespace carousel::ringbus::cycle {

namespace {

// The values are those of the models of Ramulator 2.1 (H. Luo et al., Ramulator 2.0, IEEE CAL 2024, and its later
// version), which take them from the standards JESD250 (GDDR6), JESD235 (HBM2) and JESD209-5 (LPDDR5).

// A channel of 16 bits at 14 Gb/s a pin: 28 GB/s.
constexpr DramTiming kGddr6{.period_ps = 570,
                            .groups = 4,
                            .banks = 4,
                            .row_bytes = 2048,
                            .cl = 24,
                            .cwl = 6,
                            .bl = 2,
                            .rcd_read = 30,
                            .rcd_write = 20,
                            .rp = 30,
                            .ras = 60,
                            .rc = 90,
                            .ccd_short = 2,
                            .ccd_long = 4,
                            .rrd_short = 11,
                            .rrd_long = 11,
                            .faw = 43,
                            .rtp = 4,
                            .wr = 30,
                            .wtr_short = 9,
                            .wtr_long = 11,
                            .read_to_write = 24 + 1,
                            .refi = 3333,
                            .rfc = 211};

// A channel of two pseudo-channels of 64 bits each at 2 Gb/s a pin: 32 GB/s. Its refresh is that of 2 Gb; 8 Gb take
// 350.
constexpr DramTiming kHbm2{.period_ps = 1000,
                           .pseudo_channels = 2,
                           .groups = 4,
                           .banks = 4,
                           .row_bytes = 1024,
                           .cl = 14,
                           .cwl = 5,
                           .bl = 2,
                           .rcd_read = 14,
                           .rcd_write = 12,
                           .rp = 14,
                           .ras = 34,
                           .rc = 48,
                           .ccd_short = 2,
                           .ccd_long = 4,
                           .rrd_short = 4,
                           .rrd_long = 4,
                           .faw = 15,
                           .rtp = 5,
                           .wr = 16,
                           .wtr_short = 6,
                           .wtr_long = 8,
                           .read_to_write = 14 + 2 + 2 - 5,
                           .refi = 3900,
                           .rfc = 160,
                           .activate_cycles = 2,
                           .two_buses = true};

// A channel of 16 bits at 6.4 Gb/s a pin, the command clock an eighth of it: 12.8 GB/s. Its refresh is that of 8 Gb. A
// burst takes four cycles of its group, two more than of the data bus, and nWTR long begins behind these.
constexpr DramTiming kLpddr5{.period_ps = 1250,
                             .groups = 4,
                             .banks = 4,
                             .row_bytes = 2048,
                             .cl = 17,
                             .cwl = 9,
                             .bl = 2,
                             .rcd_read = 15,
                             .rcd_write = 15,
                             .rp = 15,
                             .ras = 34,
                             .rc = 49,
                             .ccd_short = 2,
                             .ccd_long = 4,
                             .rrd_short = 4,
                             .rrd_long = 4,
                             .faw = 16,
                             .rtp = 8,
                             .wr = 28,
                             .wtr_short = 5,
                             .wtr_long = 10 + 2,
                             .read_to_write = 17 + 2 + 2 - 9,
                             .refi = 3125,
                             .rfc = 168,
                             .ppd = 2,
                             .aad = 8,
                             .clock_post = 1};

const DramTiming& preset(DramConfig::Preset preset) {
  switch (preset) {
    case DramConfig::Preset::kGddr6:
      return kGddr6;
    case DramConfig::Preset::kHbm2:
      return kHbm2;
    case DramConfig::Preset::kLpddr5:
      return kLpddr5;
    case DramConfig::Preset::kPipe:
      break;
  }
  throw SimulationError("a pipe has no banks");
}

}  // namespace

DramTiming dram_timing(const DramConfig& config) {
  DramTiming out = preset(config.preset);
  out.period_ps = config.period_ps.value_or(out.period_ps);
  out.rfc = config.refresh_cycles.value_or(out.rfc);
  if (!config.refresh) out.refi = kDramNever;
  return out;
}

double peak_bytes_per_second(const DramTiming& timing) {
  return 1e12 * DramTiming::kTransactionBytes * timing.pseudo_channels /
         static_cast<double>(timing.ccd_short * timing.period_ps);
}

}  // namespace carousel::ringbus::cycle
