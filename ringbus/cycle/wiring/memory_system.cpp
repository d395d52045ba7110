#include "ringbus/cycle/wiring/memory_system.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "ringbus/cycle/parcels/door.h"

namespace carousel::ringbus::cycle {

namespace {

Channel<std::uint64_t>& channel(std::vector<std::unique_ptr<Channel<std::uint64_t>>>& into, ChannelList& list,
                                MessageKind kind, const ChannelEnds& ends) {
  return *into.emplace_back(std::make_unique<Channel<std::uint64_t>>(list.at(kind, ends)));
}

/// Runs agents that send each other things, event by event in the order of time.
void run_to_rest(const std::vector<Agent*>& agents) {
  for (;;) {
    Agent* first = nullptr;
    Cycle earliest = kNever;  // by the fastest clock, of which anything that is sent takes a cycle
    for (Agent* agent : agents) {
      const Cycle next = agent->next();
      if (next == kNever) continue;
      const Cycle at = agent->clock().floor_to_network(next);
      if (at < earliest) first = agent, earliest = at;
    }
    if (first == nullptr) return;
    first->run(first->next() + 1);
  }
}

}  // namespace

MemorySystem::MemorySystem(ChannelList& list, const MemoryKinds& kinds, const std::optional<OwnCacheKinds>& own_kinds,
                           const AgentNumbers& agents, const MemoryConfig& config,
                           const std::vector<MemoryConfig>& own_configs, const MachineClocks& clocks,
                           const std::vector<ShapeCache::Client>& clients,
                           const std::vector<std::vector<ShapeCache::Client>>& others, const DrawnAskers* drawn)
    : shared_by_(static_cast<std::size_t>(config.shared_by)) {
  std::vector<ShapeCache::OwnCache> own;
  const Cycle own_answer = agents.caches_drawn ? kDoorCycles : ShapeCache::answer_latency(config);
  for (std::size_t r = 0; r < clients.size() && own_kinds; ++r) {
    const std::uint32_t l1 = agents.own_cache(r), l2 = agents.cache_behind(r);
    const MemoryConfig own_config = ShapeCache::own_cache(own_configs[r]);
    Channel<std::uint64_t>& down =
        channel(own_down_, list, own_kinds->requests, {l1, l2, MemoryAgent::request_latency(own_config)});
    Channel<std::uint64_t>& up = channel(own_up_, list, own_kinds->lines, {l2, l1, own_answer});
    own_.push_back(std::make_unique<ShapeCache>(own_config, std::vector{clients[r]}, down, up));
    own_.back()->ask_a_cache();
    own.push_back({&down, &up});
  }
  if (drawn != nullptr && !drawn->caches.empty()) {
    for (const DrawnAskers::AtCache& askers : drawn->caches)
      add_cache(list, kinds, agents, config, askers.own_caches, askers.resources);
  } else {
    for (std::size_t first = 0; first < clients.size(); first += shared_by_) {
      const std::size_t last = std::min(clients.size(), first + shared_by_);
      const auto sharers = [&](const auto& all) {
        return std::vector(all.begin() + static_cast<std::ptrdiff_t>(first),
                           all.begin() + static_cast<std::ptrdiff_t>(last));
      };
      std::vector<ShapeCache::Client> askers;
      if (own.empty()) askers = sharers(clients);
      const std::vector<ShapeCache::Client>& more = others[caches_.size()];
      askers.insert(askers.end(), more.begin(), more.end());
      add_cache(list, kinds, agents, config, own.empty() ? std::vector<ShapeCache::OwnCache>{} : sharers(own),
                std::move(askers));
    }
  }
  if (drawn != nullptr && !drawn->memories.empty()) {
    for (const DrawnAskers::AtMemory& memory : drawn->memories) {
      memories_.push_back(make_memory(config, clocks.of(memory.mhz), memory.askers));
      memories_.back()->tell_time(clocks.from_core(memory.mhz));
    }
  } else {
    memories_.push_back(make_memory(config, clocks.of(0), to_memory()));
  }
  const auto width = static_cast<std::uint64_t>(std::max(1.0, std::round(peak_bytes_per_cycle())));
  list.set_width(kinds.lines, width);
  list.set_width(kinds.written, width);
}

void MemorySystem::add_cache(ChannelList& list, const MemoryKinds& kinds, const AgentNumbers& agents,
                             const MemoryConfig& config, std::vector<ShapeCache::OwnCache> own_caches,
                             std::vector<ShapeCache::Client> askers) {
  const std::uint32_t l2 = agents.cache(caches_.size()), dram = agents.memory_behind(caches_.size());
  const Cycle answer = agents.memories_drawn ? kDoorCycles : MemoryAgent::answer_latency(config);
  Channel<std::uint64_t>& down =
      channel(to_memory_, list, kinds.requests, {l2, dram, MemoryAgent::request_latency(config)});
  Channel<std::uint64_t>& up = channel(from_memory_, list, kinds.lines, {dram, l2, answer});
  caches_.push_back(std::make_unique<ShapeCache>(config, std::move(own_caches), std::move(askers), down, up));
}

std::vector<MemoryAgent::Client> MemorySystem::ends(const Channels& down, const Channels& up) {
  std::vector<MemoryAgent::Client> out;
  for (std::size_t i = 0; i < down.size(); ++i) out.push_back({down[i].get(), up[i].get()});
  return out;
}

MemoryCounts MemorySystem::counts() const {
  MemoryCounts sum;
  for (const auto& memory : memories_) sum += memory->counts();
  return sum;
}

double MemorySystem::peak_bytes_per_cycle() const {
  double sum = 0;
  for (const auto& memory : memories_) sum += memory->peak_bytes_per_cycle();
  return sum;
}

std::optional<DramUse> MemorySystem::dram_use(Cycle end) const {
  std::optional<DramUse> sum = memories_.front()->dram_use(end);
  for (std::size_t i = 1; i < memories_.size() && sum; ++i) {
    const std::optional<DramUse> one = memories_[i]->dram_use(end);
    sum->cycles = std::max(sum->cycles, one->cycles);
    sum->peak_bytes_per_second += one->peak_bytes_per_second;
    sum->channels.insert(sum->channels.end(), one->channels.begin(), one->channels.end());
  }
  return sum;
}

void MemorySystem::warm(const WarmCaches& from) {
  const auto hold = [](const auto& caches, const CacheLines* lines, double begin, double end) {
    if (lines == nullptr || lines->size() != caches.size()) return;
    for (std::size_t c = 0; c < caches.size(); ++c) caches[c]->warm((*lines)[c], begin, end);
  };
  hold(caches_, from.start, from.part, 1);  // first, since they are older
  hold(caches_, from.lines, 0, from.part);
  hold(own_, from.own, 0, from.part);
}

CacheDrain MemorySystem::drain(Cycle end, const std::vector<Agent*>& between, Cycle quiet_from) {
  CacheDrain out;
  const MemoryCounts before = counts();
  Cycle begin = std::max(end, quiet_from);
  for (const auto& memory : memories_) {
    memory->log(nullptr);
    begin = std::max(begin, memory->last_step());
  }
  for (const auto& cache : caches_) cache->drain(begin);
  if (between.empty()) {
    for (const auto& memory : memories_) memory->run(kNever);
  } else {
    std::vector<Agent*> all = between;
    for (const auto& memory : memories_) all.push_back(memory.get());
    run_to_rest(all);
  }
  const MemoryCounts after = counts();
  out.lines = after.lines_written - before.lines_written;
  out.bytes = out.lines * memories_.front()->line_bytes();
  if (out.lines == 0) return out;
  for (const auto& memory : memories_)
    if (memory->idle_from() > end) out.cycles = std::max(out.cycles, memory->idle_from() - end);
  return out;
}

void MemorySystem::count_written(ByteRow& row) const {
  for (const auto& cache : caches_) {
    const CacheCounts& counts = cache->statistics();
    row.messages += counts.written + counts.written_back + counts.drained;
  }
  row.bytes = row.messages * memories_.front()->line_bytes();
  row.bytes_taken = counts().lines_written * memories_.front()->line_bytes();
}

}  // namespace carousel::ringbus::cycle
