#include "ringbus/cycle/memory/shape_cache.h"

#include <algorithm>

#include <fmt/format.h>

#include "ringbus/cycle/memory/memory.h"

namespace carousel::ringbus::cycle {

Cycle ShapeCache::request_latency(const MemoryConfig& config) {
  return way_there(config.l2_latency_cycles);
}

Cycle ShapeCache::answer_latency(const MemoryConfig& config) {
  return way_back(config.l2_latency_cycles);
}

ShapeCache::ShapeCache(const MemoryConfig& config, std::vector<Client> clients, Channel<std::uint64_t>& to_memory,
                       Channel<std::uint64_t>& from_memory)
    : answer_latency_(answer_latency(config)),
      memory_latency_(Memory::request_latency(config)),
      cache_(static_cast<std::uint64_t>(config.l2_kib) * 1024, static_cast<std::uint64_t>(config.line_bytes),
             static_cast<std::uint64_t>(config.ways)),
      clients_(std::move(clients)),
      last_answer_(clients_.size()),
      to_memory_(to_memory),
      from_memory_(from_memory) {}

Cycle ShapeCache::next() const {
  Cycle first = from_memory_.next();
  for (const Client& client : clients_) first = std::min(first, client.requests->next());
  return first;
}

void ShapeCache::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) {
    while (from_memory_.next() <= now) fill(from_memory_.take(), now);
    for (std::size_t c = 0; c < clients_.size(); ++c)
      while (clients_[c].requests->next() <= now) look_up(c, clients_[c].requests->take(), now);
  }
}

void ShapeCache::look_up(std::size_t client, const FetchRequest& request, Cycle now) {
  std::uint32_t index;
  if (free_pending_.empty()) {
    index = static_cast<std::uint32_t>(pending_.size());
    pending_.emplace_back();
  } else {
    index = free_pending_.back();
    free_pending_.pop_back();
  }
  pending_[index] = {client, request.tag, 0, 0};
  ++statistics_.requests;
  statistics_.lines += request.lines;
  port_free_ = std::max(port_free_, now);
  for (std::uint64_t line = request.first_line; line < request.first_line + request.lines; ++line) {
    pending_[index].ready = ++port_free_;
    if (cache_.touch(line)) {
      ++statistics_.hits;
      continue;
    }
    ++pending_[index].lines_missing;
    std::vector<std::uint32_t>& waiting = missing_[line];
    if (waiting.empty()) {
      to_memory_.send(port_free_ + memory_latency_, line);
      ++statistics_.misses;
    } else {
      ++statistics_.merged;
    }
    waiting.push_back(index);
  }
  if (pending_[index].lines_missing > 0) return;
  answer(pending_[index]);
  free_pending_.push_back(index);
}

void ShapeCache::fill(std::uint64_t line, Cycle now) {
  cache_.insert(line);
  const auto found = missing_.find(line);
  for (const std::uint32_t index : found->second) {
    Pending& pending = pending_[index];
    pending.ready = std::max(pending.ready, now);
    if (--pending.lines_missing > 0) continue;
    answer(pending);
    free_pending_.push_back(index);
  }
  missing_.erase(found);
}

void ShapeCache::answer(const Pending& pending) {
  Cycle& last = last_answer_[pending.client];
  last = std::max(last, pending.ready + answer_latency_);
  clients_[pending.client].answers->send(last, {pending.tag});
}

std::string ShapeCache::describe() const {
  if (missing_.empty()) return "";
  return fmt::format("cache: {} lines on their way from memory", missing_.size());
}

}  // namespace carousel::ringbus::cycle
