#include "ringbus/cycle/memory/shape_cache.h"

#include <algorithm>
#include <bit>

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
      line_bytes_(fetched_bytes(config)),
      parts_(static_cast<std::uint64_t>(config.line_bytes) / line_bytes_),
      writes_back_(config.l2_write == MemoryConfig::Write::kBack),
      mshrs_(static_cast<std::uint64_t>(config.l2_mshrs)),
      cache_(static_cast<std::uint64_t>(config.l2_kib) * 1024, static_cast<std::uint64_t>(config.line_bytes),
             static_cast<std::uint64_t>(config.ways), parts_, writes_back_),
      banks_(static_cast<std::size_t>(config.l2_banks)),
      clients_(std::move(clients)),
      to_memory_(to_memory),
      from_memory_(from_memory),
      port_lines_(static_cast<std::uint64_t>(config.l2_lines_per_cycle)),
      in_order_(banks_.size() == 1 && !writes_back_) {}

ShapeCache::ShapeCache(const MemoryConfig& config, std::vector<OwnCache> clients, Channel<std::uint64_t>& to_memory,
                       Channel<std::uint64_t>& from_memory)
    : ShapeCache(config, std::vector<Client>{}, to_memory, from_memory) {
  own_caches_ = std::move(clients);
}

MemoryConfig ShapeCache::own_cache(const MemoryConfig& config) {
  MemoryConfig out = config;
  out.l2_kib = config.l1_kib;
  out.ways = config.l1_ways;
  out.l2_lines_per_cycle = config.l1_lines_per_cycle;
  out.l2_mshrs = config.l1_mshrs;
  out.l2_latency_cycles = config.l1_latency_cycles;
  out.dram_latency_cycles = config.l2_latency_cycles;
  out.l2_banks = 1;
  out.l2_write = MemoryConfig::Write::kThrough;
  return out;
}

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
  if (!outgoing_.empty()) first = std::min(first, outgoing_.top().ready);
  for (const Client& client : clients_) first = std::min(first, client.requests->next());
  for (const OwnCache& client : own_caches_) first = std::min(first, client.requests->next());
  return first;
}

void ShapeCache::run(Cycle end) {
  for (next_ = next(); next_ < end;) {
    const Cycle now = next_;
    while (from_memory_.next() <= now) fill(from_memory_.take(), now);
    next_ = from_memory_.next();
    for (std::uint32_t c = 0; c < clients_.size(); ++c) {
      Channel<FetchRequest>& requests = *clients_[c].requests;
      while (requests.next() <= now) take(c, requests.take(), now);
      next_ = std::min(next_, requests.next());
    }
    for (std::uint32_t c = 0; c < own_caches_.size(); ++c) {
      Channel<std::uint64_t>& requests = *own_caches_[c].requests;
      while (requests.next() <= now) take_line(c, requests.take(), now);
      next_ = std::min(next_, requests.next());
    }
    for (; !answers_.empty() && answers_.top().ready <= now; answers_.pop()) answer(answers_.top(), now);
    if (!answers_.empty()) next_ = std::min(next_, answers_.top().ready);
    for (; !outgoing_.empty() && outgoing_.top().ready <= now; outgoing_.pop())
      to_memory_.send(now + memory_latency_, outgoing_.top().line);
    if (!outgoing_.empty()) next_ = std::min(next_, outgoing_.top().ready);
  }
}

/// Takes a port of the bank for the next line. Returns the end of the cycle in which it is looked up.
Cycle ShapeCache::take_port(Bank& bank, Cycle now) {
  bank.looked_up = std::max(bank.looked_up, now * port_lines_) + 1;
  const Cycle end = ceil_div(bank.looked_up, port_lines_);
  statistics_.port_waits += end > now + 1;
  statistics_.port_busy += end > bank.busy_until;
  bank.busy_until = end;
  return end;
}

void ShapeCache::to_memory(Cycle leaves, std::uint64_t request) {
  if (in_order_)
    to_memory_.send(leaves + memory_latency_, request);
  else
    outgoing_.push({leaves, next_turn_++, request});
}

// ---- requests

void ShapeCache::take(std::uint32_t client, const FetchRequest& request, Cycle now) {
  if (request.written > 0) [[unlikely]]
    return writes_back_ ? write_back(request, now) : write_through(request, now);
  const std::uint32_t index = begin({client, request.tag, request.lines});
  ++statistics_.requests;
  statistics_.lines += request.lines;
  for (std::uint32_t i = 0; i < request.lines; ++i) look_up({request.first_line + i, index}, now);
}

/// A request of an own cache.
void ShapeCache::take_line(std::uint32_t client, std::uint64_t request, Cycle now) {
  const std::uint64_t line = request & ~(kWriteLine | kWholeLine);
  if ((request & kWriteLine) == 0) {
    ++statistics_.requests;
    ++statistics_.lines;
    return look_up({line, begin({client, 0, 1, 0, line})}, now);
  }
  if (!writes_back_) {
    cache_.touch(line);
    to_memory(take_port(bank_of(line), now), kWriteLine | line);
    ++statistics_.written;
    return;
  }
  look_up({line, (request & kWholeLine) != 0 ? kWholeWriter : kWriter}, now);
  ++statistics_.kept;
}

std::uint32_t ShapeCache::begin(const Pending& pending) {
  if (free_pending_.empty()) {
    pending_.push_back(pending);
    return static_cast<std::uint32_t>(pending_.size() - 1);
  }
  const std::uint32_t index = free_pending_.back();
  free_pending_.pop_back();
  pending_[index] = pending;
  return index;
}

void ShapeCache::answer(const Answer& answer, Cycle now) {
  if (own_caches_.empty())
    clients_[answer.client].answers->send(now + answer_latency_, {answer.tag});
  else
    own_caches_[answer.client].answers->send(now + answer_latency_, answer.line);
}

void ShapeCache::write_through(const FetchRequest& request, Cycle now) {
  for (std::uint64_t i = 0; i < request.lines; ++i) {
    const std::uint64_t line = request.first_line + i;
    cache_.touch(line);
    to_memory(take_port(bank_of(line), now),
              kWriteLine | line | (asks_a_cache_ && writes_whole(request, i) ? kWholeLine : 0));
    ++statistics_.written;
  }
}

/// Returns whether the request writes all of its i-th line.
bool ShapeCache::writes_whole(const FetchRequest& request, std::uint64_t i) const {
  return (i > 0 || request.skipped == 0) && (i + 1) * line_bytes_ <= std::uint64_t{request.skipped} + request.written;
}

void ShapeCache::write_back(const FetchRequest& request, Cycle now) {
  for (std::uint64_t i = 0; i < request.lines; ++i)
    look_up({request.first_line + i, writes_whole(request, i) ? kWholeWriter : kWriter}, now);
  statistics_.kept += request.lines;
}

/// Looks up a line, unless its bank has stopped at one before it or stops at this one.
void ShapeCache::look_up(const LookUp& one, Cycle now) {
  Bank& bank = bank_of(one.line);
  if (bank.waiting.empty() && (one.request >= kWholeWriter ? write(bank, one, now) : read(bank, one, now))) return;
  bank.waiting.push_back(one);
  ++statistics_.mshr_waits;
}

/// Returns whether the line could be looked up.
bool ShapeCache::read(Bank& bank, const LookUp& one, Cycle now) {
  Pending& pending = pending_[one.request];
  if (cache_.touch(one.line)) {
    pending.ready = std::max(pending.ready, take_port(bank, now));
    ++statistics_.hits;
    if (--pending.lines_missing == 0) complete(one.request);
    return true;
  }
  if (!can_fetch(bank) && !missing_.has(one.line)) return false;
  const Cycle looked_up = take_port(bank, now);
  pending.ready = std::max(pending.ready, looked_up);
  if (missing_.wait(one.line, one.request)) {
    to_memory(looked_up, one.line);
    ++bank.on_their_way;
    ++statistics_.misses;
  } else {
    ++statistics_.merged;
  }
  return true;
}

bool ShapeCache::write(Bank& bank, const LookUp& one, Cycle now) {
  const bool here = cache_.touch(one.line);
  if (here || (one.request == kWholeWriter && !missing_.has(one.line))) {
    const Cycle looked_up = take_port(bank, now);
    if (!here) insert(one.line, looked_up);
    cache_.written(one.line);
    return true;
  }
  if (!can_fetch(bank) && !missing_.has(one.line)) return false;
  const Cycle looked_up = take_port(bank, now);
  if (missing_.wait(one.line, kWriter)) {
    to_memory(looked_up, one.line);
    ++bank.on_their_way;
    ++statistics_.write_fetches;
  }
  return true;
}

// ---- lines that come

void ShapeCache::insert(std::uint64_t line, Cycle now) {
  const LineCache::Replaced replaced = cache_.insert(line);
  for (std::uint64_t written = replaced.written; written != 0; written &= written - 1) {
    to_memory(now, kWriteLine | (replaced.first_part + static_cast<std::uint64_t>(std::countr_zero(written))));
    ++statistics_.written_back;
  }
}

void ShapeCache::fill(std::uint64_t line, Cycle now) {
  insert(line, now);
  missing_.come(line, [&](std::uint32_t index) {
    if (index == kWriter) return cache_.written(line);
    Pending& pending = pending_[index];
    pending.ready = std::max(pending.ready, now);
    if (--pending.lines_missing == 0) complete(index);
  });
  Bank& bank = bank_of(line);
  --bank.on_their_way;
  for (; !bank.waiting.empty(); bank.waiting.pop_front()) {
    const LookUp one = bank.waiting.front();
    if (!(one.request >= kWholeWriter ? write(bank, one, now) : read(bank, one, now))) return;
  }
}

void ShapeCache::complete(std::uint32_t index) {
  const Pending& pending = pending_[index];
  answers_.push({pending.ready, next_turn_++, pending.client, pending.tag, pending.line});
  free_pending_.push_back(index);
}

std::string ShapeCache::describe() const {
  if (missing_.size() == 0) return "";
  return fmt::format("cache: {} lines on their way from memory", missing_.size());
}

}  // namespace carousel::ringbus::cycle
