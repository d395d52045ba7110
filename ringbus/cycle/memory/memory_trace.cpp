#include "ringbus/cycle/memory/memory_trace.h"

#include <algorithm>
#include <chrono>

#include "ringbus/cycle/memory/dram/dram.h"
#include "ringbus/cycle/memory/memory_agent.h"

namespace carousel::ringbus {

namespace {

using namespace cycle;

constexpr std::size_t kLookEvery = 4096;  // requests between two looks at the stop token

void run_pipe(const MemoryConfig& config, const MemoryLog& requests, MemoryTraceResult& out) {
  const auto width = static_cast<std::uint64_t>(config.dram_bytes_per_cycle);
  const Cycle latency = MemoryAgent::request_latency(config) + MemoryAgent::answer_latency(config);
  std::uint64_t moved = 0;
  for (const MemoryRequest& request : requests) {
    moved = std::max(moved, request.cycle * width) + request.bytes;
    out.last_taken = request.cycle;
    const Cycle end = ceil_div(moved, width) + (request.write ? 0 : latency);
    out.cycles = std::max(out.cycles, end);
    if (!request.write) out.latency.add(end - request.cycle);
  }
}

void run_banks(const MemoryConfig& config, std::int64_t clock_mhz, const MemoryLog& requests,
               const std::stop_token& stop, MemoryTraceResult& out) {
  Dram dram(config.dram, clock_mhz);
  Cycle last = 0;
  const auto answer = [&](std::uint64_t index, DramCycle done) {
    const Cycle end = dram.engine_end(done);
    last = std::max(last, end);
    out.latency.add(end - requests[index].cycle);
  };
  for (std::size_t i = 0; i < requests.size() && out.complete; ++i) {
    if (i % kLookEvery == 0) out.complete = !stop.stop_requested();
    const MemoryRequest& request = requests[i];
    const DramCycle at = dram.of_engine(request.cycle);
    dram.run(at, answer);
    dram.push(request.address, request.bytes, request.write, i, at);
  }
  dram.run(kDramNever, answer);
  const DramCycle taken = dram.last_taken();
  out.last_taken = dram.engine_of(taken);
  out.cycles = std::max(last, dram.engine_end(taken));
  dram.close(dram.of_engine(out.cycles));
  out.dram = dram.use(dram.of_engine(out.cycles));
}

}  // namespace

MemoryTraceResult run_memory_trace(const MemoryConfig& config, std::int64_t clock_mhz, const MemoryLog& requests,
                                   std::stop_token stop) {
  const auto start = std::chrono::steady_clock::now();
  MemoryTraceResult out;
  out.requests = requests.size();
  for (const MemoryRequest& request : requests) {
    ++(request.write ? out.writes : out.reads);
    out.bytes += request.bytes;
  }
  if (config.dram.preset == DramConfig::Preset::kPipe)
    run_pipe(config, requests, out);
  else
    run_banks(config, clock_mhz, requests, stop, out);
  out.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

}  // namespace carousel::ringbus
