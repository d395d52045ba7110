#include "ringbus/cycle/wiring/memory_system.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

MemorySystem::MemorySystem(ChannelList& list, const MemoryKinds& kinds, const std::optional<OwnCacheKinds>& own_kinds,
                           const AgentNumbers& agents, const MemoryConfig& config, std::int64_t clock_mhz,
                           const std::vector<ShapeCache::Client>& clients,
                           const std::vector<std::vector<ShapeCache::Client>>& others)
    : shared_by_(static_cast<std::size_t>(config.shared_by)) {
  const auto channel = [&](auto& into, MessageKind kind, const ChannelEnds& ends) -> Channel<std::uint64_t>& {
    return *into.emplace_back(std::make_unique<Channel<std::uint64_t>>(list.at(kind, ends)));
  };
  std::vector<MemoryAgent::Client> memory_clients;
  std::vector<ShapeCache::OwnCache> own;
  const MemoryConfig own_config = ShapeCache::own_cache(config);
  for (std::size_t r = 0; r < clients.size() && own_kinds; ++r) {
    const std::uint32_t l1 = agents.own_cache(r), l2 = agents.cache_behind(r);
    Channel<std::uint64_t>& down =
        channel(own_down_, own_kinds->requests, {l1, l2, MemoryAgent::request_latency(own_config)});
    Channel<std::uint64_t>& up = channel(own_up_, own_kinds->lines, {l2, l1, ShapeCache::answer_latency(config)});
    own_.push_back(std::make_unique<ShapeCache>(own_config, std::vector{clients[r]}, down, up));
    own_.back()->ask_a_cache();
    own.push_back({&down, &up});
  }
  for (std::size_t first = 0; first < clients.size(); first += shared_by_) {
    const std::size_t last = std::min(clients.size(), first + shared_by_);
    const std::uint32_t l2 = agents.cache_behind(first), dram = agents.memory();
    Channel<std::uint64_t>& down =
        channel(to_memory_, kinds.requests, {l2, dram, MemoryAgent::request_latency(config)});
    Channel<std::uint64_t>& up = channel(from_memory_, kinds.lines, {dram, l2, MemoryAgent::answer_latency(config)});
    const auto sharers = [&](const auto& all) {
      return std::vector(all.begin() + static_cast<std::ptrdiff_t>(first),
                         all.begin() + static_cast<std::ptrdiff_t>(last));
    };
    std::vector<ShapeCache::Client> askers;
    if (own.empty()) askers = sharers(clients);
    const std::vector<ShapeCache::Client>& more = others[caches_.size()];
    askers.insert(askers.end(), more.begin(), more.end());
    const std::vector<ShapeCache::OwnCache> before = own.empty() ? std::vector<ShapeCache::OwnCache>{} : sharers(own);
    caches_.push_back(std::make_unique<ShapeCache>(config, before, std::move(askers), down, up));
    memory_clients.push_back({&down, &up});
  }
  memory_ = make_memory(config, clock_mhz, std::move(memory_clients));
  const auto width = static_cast<std::uint64_t>(memory_->peak_bytes_per_cycle());
  list.set_width(kinds.lines, width);
  list.set_width(kinds.written, width);
}

void MemorySystem::warm(const WarmCaches& from) {
  if (from.lines == nullptr || from.lines->size() != caches_.size()) return;
  for (std::size_t c = 0; c < caches_.size(); ++c) caches_[c]->warm((*from.lines)[c], from.part);
}

CacheDrain MemorySystem::drain(Cycle end) {
  CacheDrain out;
  const MemoryCounts before = memory_->counts();
  memory_->log(nullptr);
  const Cycle begin = std::max(end, memory_->last_step());
  for (const auto& cache : caches_) cache->drain(begin);
  memory_->run(kNever);
  const MemoryCounts after = memory_->counts();
  out.lines = after.lines_written - before.lines_written;
  out.bytes = out.lines * memory_->line_bytes();
  if (out.lines > 0) out.cycles = memory_->idle_from() - end;
  return out;
}

void MemorySystem::count_written(ByteRow& row) const {
  for (const auto& cache : caches_) {
    const CacheCounts& counts = cache->statistics();
    row.messages += counts.written + counts.written_back + counts.drained;
  }
  row.bytes = row.messages * memory_->line_bytes();
  row.bytes_taken = memory_->counts().lines_written * memory_->line_bytes();
}

}  // namespace carousel::ringbus::cycle
