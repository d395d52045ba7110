#include "app/build_report/memory_report.h"

#include "app/build_report/build_report.h"
#include "report/text/ratio.h"

namespace carousel::app {

using report::ratio;

report::Dram dram_section(const ringbus::DramUse& use) {
  report::Dram out;
  out.cycles = use.cycles;
  out.period_ps = use.period_ps;
  out.peak_bytes_per_second = use.peak_bytes_per_second;
  DramCounts sum;
  for (const ringbus::DramUse::Channel& channel : use.channels) {
    sum += channel.counts;
    out.channels.push_back(
        {channel.counts, channel.bytes, channel.utilisation, {report::latency_of(channel.latencies)}});
  }
  out.row_hit_fraction = ratio(sum.row_hits, sum.reads + sum.writes);
  out.refresh_fraction = ratio(sum.refresh_cycles, use.cycles * use.channels.size());
  return out;
}

report::Report memory_report(const Prepared& prepared, const ringbus::MemoryTraceResult& result) {
  const Config& config = prepared.config();
  report::Report r = report_without_rays(prepared, result.complete, result.cycles, 1, result.wall_seconds);
  report::MemoryTrace& m = r.memory_trace.emplace();
  m.requests = result.requests;
  m.reads = result.reads;
  m.writes = result.writes;
  m.bytes = result.bytes;
  m.last_taken_cycle = result.last_taken;
  m.bytes_per_cycle = ratio(result.bytes, result.cycles);
  m.gigabytes_per_second = m.bytes_per_cycle * static_cast<double>(config.engine.clock_mhz) / 1000;
  m.latency = {report::latency_of(result.latency)};
  if (result.dram) m.dram = dram_section(*result.dram);
  return r;
}

}  // namespace carousel::app
