#include "ringbus/cycle/shading/shading_agent.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

ShadingAgent::ShadingAgent(Machine& machine, Workload& workload, const Observation& observed, std::vector<Pool> pools)
    : trace_(static_cast<std::uint32_t>(machine.topology.resources()), observed.steps) {
  for (std::size_t i = 0; i < pools.size(); ++i)
    pools_.push_back(std::make_unique<ShadingPool>(ShadingPool::Shared{machine, workload, camera_, trace_},
                                                   machine.pools.empty() ? machine.control : *machine.pools[i],
                                                   pools[i].settings, observed.samples, std::move(pools[i].clients)));
}

bool ShadingAgent::done() const {
  return camera_.finished && std::ranges::all_of(pools_, [](const auto& pool) { return pool->none(); });
}

Cycle ShadingAgent::next() const {
  Cycle first = started_ ? kNever : 0;
  const bool all = done();
  for (const auto& pool : pools_) first = std::min(first, pool->next_of_all(all));
  return first;
}

void ShadingAgent::notify(Cycle at) {
  for (const auto& pool : pools_) pool->announce(at);
}

void ShadingAgent::run(Cycle end) {
  for (const auto& pool : pools_) pool->open_window(end);
  const auto next_known = [&] {
    if (!started_) return Cycle{0};
    Cycle first = kNever;
    const bool all = done();
    for (const auto& pool : pools_) first = std::min(first, pool->next(all));
    return first;
  };
  while ((next_ = next_known()) < end) step(next_);
}

void ShadingAgent::step(Cycle now) {
  started_ = true;
  now_ = now;
  for (const auto& pool : pools_) pool->arrive(now);
  // What one pool has shaded may let the workload have camera rays for another.
  for (bool again = true; again;) {
    again = false;
    for (const auto& pool : pools_) again |= pool->work(now);
    again &= pools_.size() > 1;
  }
  for (const auto& pool : pools_) pool->place(now);
}

std::uint64_t ShadingAgent::emitted() const {
  std::uint64_t sum = 0;
  for (const auto& pool : pools_) sum += pool->emitted();
  return sum;
}

std::uint64_t ShadingAgent::completed() const {
  std::uint64_t sum = 0;
  for (const auto& pool : pools_) sum += pool->completed();
  return sum;
}

Cycle ShadingAgent::busy() const {
  Cycle sum = 0;
  for (const auto& pool : pools_) sum += pool->busy();
  return sum;
}

ShadingCounts ShadingAgent::counts() const {
  ShadingCounts sum;
  for (const auto& pool : pools_) sum += pool->counts();
  return sum;
}

Log2Histogram ShadingAgent::residence() const {
  Log2Histogram sum;
  for (const auto& pool : pools_) sum += pool->residence();
  return sum;
}

void ShadingAgent::close(Cycle end) {
  for (const auto& pool : pools_) pool->close(end);
}

void ShadingAgent::record(const Recording& recording) {
  for (const auto& pool : pools_) pool->record(recording);
}

std::string ShadingAgent::describe() const {
  if (done()) return "";
  std::string text;
  for (std::size_t i = 0; i < pools_.size(); ++i)
    text += (i > 0 ? "\n  " : "") + (pools_.size() > 1 ? fmt::format("pool {}: ", i) : "") + pools_[i]->describe();
  return text;
}

}  // namespace carousel::ringbus::cycle
