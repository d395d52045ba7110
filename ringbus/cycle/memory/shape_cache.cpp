#include "ringbus/cycle/memory/shape_cache.h"

#include <algorithm>

#include <fmt/format.h>

#include "ringbus/cycle/memory/memory_agent.h"

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
      memory_latency_(MemoryAgent::request_latency(config)),
      cache_(static_cast<std::uint64_t>(config.l2_kib) * 1024, static_cast<std::uint64_t>(config.line_bytes),
             static_cast<std::uint64_t>(config.ways)),
      clients_(std::move(clients)),
      to_memory_(to_memory),
      from_memory_(from_memory),
      port_lines_(static_cast<std::uint64_t>(config.l2_lines_per_cycle)) {}

void ShapeCache::warm(std::span<const std::uint64_t> lines, double part) {
  for (const std::uint64_t line : lines) {
    const std::uint64_t mixed = (line + 1) * 0x9e3779b97f4a7c15ull,
                        drawn = (mixed ^ (mixed >> 31)) * 0xbf58476d1ce4e5b9ull;
    if (static_cast<double>(drawn >> 11) * 0x1p-53 < part) cache_.insert(line);
  }
}

Cycle ShapeCache::next() const {
  Cycle first = from_memory_.next();
  if (!answers_.empty()) first = std::min(first, answers_.top().ready);
  for (const Client& client : clients_) first = std::min(first, client.requests->next());
  return first;
}

void ShapeCache::run(Cycle end) {
  for (next_ = next(); next_ < end;) {
    const Cycle now = next_;
    while (from_memory_.next() <= now) fill(from_memory_.take(), now);
    next_ = from_memory_.next();
    for (std::uint32_t c = 0; c < clients_.size(); ++c) {
      Channel<FetchRequest>& requests = *clients_[c].requests;
      while (requests.next() <= now) look_up(c, requests.take(), now);
      next_ = std::min(next_, requests.next());
    }
    for (; !answers_.empty() && answers_.top().ready <= now; answers_.pop())
      clients_[answers_.top().client].answers->send(now + answer_latency_, {answers_.top().tag});
    if (!answers_.empty()) next_ = std::min(next_, answers_.top().ready);
  }
}

/// Takes the port for the next line. Returns the end of the cycle in which it is looked up.
Cycle ShapeCache::take_port(Cycle now) {
  looked_up_ = std::max(looked_up_, now * port_lines_) + 1;
  const Cycle end = ceil_div(looked_up_, port_lines_);
  statistics_.port_busy += end > port_busy_until_;
  port_busy_until_ = end;
  return end;
}

void ShapeCache::write(const FetchRequest& request, Cycle now) {
  for (std::uint64_t line = request.first_line; line < request.first_line + request.lines; ++line) {
    cache_.touch(line);
    to_memory_.send(take_port(now) + memory_latency_, kWriteLine | line);
    ++statistics_.written;
  }
}

void ShapeCache::look_up(std::uint32_t client, const FetchRequest& request, Cycle now) {
  if (request.written > 0) [[unlikely]]
    return write(request, now);
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
  for (std::uint64_t line = request.first_line; line < request.first_line + request.lines; ++line) {
    const Cycle looked_up = pending_[index].ready = take_port(now);
    if (cache_.touch(line)) {
      ++statistics_.hits;
      continue;
    }
    ++pending_[index].lines_missing;
    if (missing_.wait(line, index)) {
      to_memory_.send(looked_up + memory_latency_, line);
      ++statistics_.misses;
    } else {
      ++statistics_.merged;
    }
  }
  if (pending_[index].lines_missing == 0) complete(index);
}

void ShapeCache::fill(std::uint64_t line, Cycle now) {
  cache_.insert(line);
  missing_.come(line, [&](std::uint32_t index) {
    Pending& pending = pending_[index];
    pending.ready = std::max(pending.ready, now);
    if (--pending.lines_missing == 0) complete(index);
  });
}

void ShapeCache::complete(std::uint32_t index) {
  const Pending& pending = pending_[index];
  answers_.push({pending.ready, next_turn_++, pending.client, pending.tag});
  free_pending_.push_back(index);
}

std::string ShapeCache::describe() const {
  if (missing_.size() == 0) return "";
  return fmt::format("cache: {} lines on their way from memory", missing_.size());
}

}  // namespace carousel::ringbus::cycle
