#include "report/run/memory_table.h"

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/ratio.h"

namespace carousel::report {

std::string memory_table(const Report& report) {
  const MemoryTrace& m = *report.memory_trace;
  std::string out;
  const auto line = [&](std::string_view name, const std::string& text) {
    out += fmt::format("{:<13}{}\n", name, text);
  };
  if (report.incomplete) line("INCOMPLETE", "the work was interrupted; this is the part that was done");
  line("requests", fmt::format("{}   {} reads   {} writes   {}", grouped(m.requests), grouped(m.reads),
                               grouped(m.writes), bytes_text(m.bytes)));
  line("simulated", fmt::format("{} cycles   {:.3f} bytes a cycle   {:.2f} GB/s",
                                grouped(report.engine.cycles.value_or(0)), m.bytes_per_cycle, m.gigabytes_per_second));
  const Latency& l = m.latency.of;
  line("latency", fmt::format("{:.3f} mean   {} p50   {} p95   {} p99   {} max cycles", l.mean, grouped(l.p50),
                              grouped(l.p95), grouped(l.p99), grouped(l.max)));
  if (m.dram) {
    DramCounts sum;
    double busy = 0;
    for (const DramChannel& channel : m.dram->channels) {
      sum += channel.counts;
      busy += channel.utilisation;
    }
    line("rows", fmt::format("{} hits   {} misses   {} conflicts   {} refreshes, {} of the time", grouped(sum.row_hits),
                             grouped(sum.row_misses), grouped(sum.row_conflicts), grouped(sum.refreshes),
                             percent(m.dram->refresh_fraction)));
    line("channels", fmt::format("{}, {} busy on average", m.dram->channels.size(),
                                 percent(ratio(busy, static_cast<double>(m.dram->channels.size())))));
  }
  line("host", fmt::format("{} to simulate   {}requests/s", seconds_text(report.host.wall_seconds),
                           scaled(ratio(static_cast<double>(m.requests), report.host.wall_seconds))));
  return out;
}

}  // namespace carousel::report
