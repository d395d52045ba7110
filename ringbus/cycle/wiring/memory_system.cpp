#include "ringbus/cycle/wiring/memory_system.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

MemorySystem::MemorySystem(const Config& config, const std::vector<ShapeCache::Client>& clients,
                           const std::vector<ShapeCache::Client>& shading)
    : shared_by_(static_cast<std::size_t>(config.memory.shared_by)) {
  std::vector<MemoryAgent::Client> memory_clients;
  std::vector<ShapeCache::OwnCache> own;
  const MemoryConfig own_config = ShapeCache::own_cache(config.memory);
  for (std::size_t r = 0; r < clients.size() && config.memory.l1_kib > 0; ++r) {
    Channel<std::uint64_t>& down = *own_down_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
    Channel<std::uint64_t>& up = *own_up_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
    own_.push_back(std::make_unique<ShapeCache>(own_config, std::vector{clients[r]}, down, up));
    own_.back()->ask_a_cache();
    own.push_back({&down, &up});
  }
  for (std::size_t first = 0; first < clients.size(); first += shared_by_) {
    const std::size_t last = std::min(clients.size(), first + shared_by_);
    Channel<std::uint64_t>& down = *to_memory_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
    Channel<std::uint64_t>& up = *from_memory_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
    const auto sharers = [&](const auto& all) {
      return std::vector(all.begin() + static_cast<std::ptrdiff_t>(first),
                         all.begin() + static_cast<std::ptrdiff_t>(last));
    };
    std::vector<ShapeCache::Client> askers;
    if (own.empty()) askers = sharers(clients);
    if (!shading.empty()) askers.push_back(shading[caches_.size()]);
    const std::vector<ShapeCache::OwnCache> before = own.empty() ? std::vector<ShapeCache::OwnCache>{} : sharers(own);
    caches_.push_back(std::make_unique<ShapeCache>(config.memory, before, std::move(askers), down, up));
    memory_clients.push_back({&down, &up});
  }
  memory_ = make_memory(config.memory, config.engine.clock_mhz, std::move(memory_clients));
}

void MemorySystem::warm(const WarmCaches& from) {
  if (from.lines == nullptr || from.lines->size() != caches_.size()) return;
  for (std::size_t c = 0; c < caches_.size(); ++c) caches_[c]->warm((*from.lines)[c], from.part);
}

CacheDrain MemorySystem::drain(Cycle end) {
  CacheDrain out;
  const std::uint64_t before = memory_->lines_written();
  memory_->log(nullptr);
  const Cycle begin = std::max(end, memory_->last_step());
  for (const auto& cache : caches_) cache->drain(begin);
  memory_->run(kNever);
  out.lines = memory_->lines_written() - before;
  if (out.lines > 0) out.cycles = memory_->idle_from() - end;
  return out;
}

void MemorySystem::connect(WakeupTable& wakeups) const {
  for (std::size_t r = 0; r < own_.size(); ++r) {
    wakeups.connect(*own_down_[r], *own_[r], *caches_[r / shared_by_]);
    wakeups.connect(*own_up_[r], *caches_[r / shared_by_], *own_[r]);
  }
  for (std::size_t c = 0; c < caches_.size(); ++c) {
    wakeups.connect(*to_memory_[c], *caches_[c], *memory_);
    wakeups.connect(*from_memory_[c], *memory_, *caches_[c]);
  }
}

Cycle MemorySystem::least_latency(const MemoryConfig& config) {
  const MemoryConfig nearest = ShapeCache::nearest(config);
  return std::min({ShapeCache::request_latency(nearest), ShapeCache::answer_latency(nearest),
                   ShapeCache::request_latency(config), ShapeCache::answer_latency(config),
                   MemoryAgent::request_latency(config), MemoryAgent::answer_latency(config)});
}

}  // namespace carousel::ringbus::cycle
