#include "app/build_report/memory_report.h"

#include "accel/traverse/kernels.h"
#include "app/host/machine_info.h"
#include "app/host/program_info.h"
#include "app/plugins/plugins.h"
#include "core/config/write.h"
#include "core/numeric/digest.h"
#include "core/system/process_memory.h"
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
  report::Report r;
  r.incomplete = !result.complete;
  r.carousel = program_info();
  r.config = config_json(prepared.absolute_config());
  for (const IgnoredKey& ignored : prepared.ignored()) r.ignored_keys.push_back(ignored.key);
  r.plugins = plugins_section(prepared.located.plugins);
  r.scene.name = "none";
  r.engine.kind = enum_name(config.engine.kind);
  r.engine.cycles = result.cycles;
  r.engine.deterministic = true;
  r.engine.reason = "virtual time: nothing depends on the host's threads";
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
  r.digest.hits = HitsDigest().hex();  // the digest of no rays
  r.host.threads = 1;
  r.host.wall_seconds = result.wall_seconds;
  r.host.peak_memory_bytes = peak_memory_bytes();
  r.host.simd = accel::simd_targets().front();
  r.host.machine = machine_info();
  return r;
}

}  // namespace carousel::app
