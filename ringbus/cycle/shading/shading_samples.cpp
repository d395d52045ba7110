// The counters of ray control and shading over time.
#include "ringbus/cycle/shading/shading_agent.h"

namespace carousel::ringbus::cycle {

/// Takes in how things have been since the last step.
void ShadingAgent::sample(Cycle now) {
  if (samples_.due(now)) [[unlikely]]
    samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  waiting_.hold(now, to_shade());
  working_.hold(now, jobs_.size() - idle_.size());
}

void ShadingAgent::read(Cycle at, std::span<std::uint64_t> row) const {
  row[counter_index(ShadingCounter::kCompleted)] = completed_;
  row[counter_index(ShadingCounter::kWaiting)] = waiting_.at(at, to_shade());
  row[counter_index(ShadingCounter::kWorkers)] = working_.at(at, jobs_.size() - idle_.size());
  for (std::size_t r = 0; r < held_.size(); ++r) row[kFirstHeldCounter + r] = held_[r].at(at);
}

void ShadingAgent::close(Cycle end) {
  samples_.close(end, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
}

}  // namespace carousel::ringbus::cycle
