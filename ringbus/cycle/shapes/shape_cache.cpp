#include "ringbus/cycle/shapes/shape_cache.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "ringbus/cycle/memory/memory_agent.h"

namespace carousel::ringbus::cycle {

namespace {

/// Shapes stand below; spilled entries, records and states of paths above (SpillMemory, RayData).
constexpr std::uint64_t kFirstRayData = std::uint64_t{1} << 40;

/// So many ways of an L2.
LineCache line_cache(const MemoryConfig& config, std::int64_t ways) {
  const auto line_bytes = static_cast<std::uint64_t>(config.line_bytes);
  const std::uint64_t sets =
      static_cast<std::uint64_t>(config.l2_kib) * 1024 / line_bytes / static_cast<std::uint64_t>(config.ways);
  return {sets * static_cast<std::uint64_t>(ways) * line_bytes, line_bytes, static_cast<std::uint64_t>(ways),
          line_bytes / fetched_bytes(config), config.l2_write == MemoryConfig::Write::kBack};
}

}  // namespace

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
      answer_bytes_(static_cast<std::uint64_t>(config.l2_answer_bytes_per_cycle)),
      cache_(line_cache(config, config.ways - config.l2_ray_ways)),
      first_ray_line_(kFirstRayData / line_bytes_),
      banks_(static_cast<std::size_t>(config.l2_banks)),
      clients_(std::move(clients)),
      to_memory_(to_memory),
      from_memory_(from_memory),
      port_lines_(static_cast<std::uint64_t>(config.l2_lines_per_cycle)),
      in_order_(banks_.size() == 1 && !writes_back_),
      walks_(static_cast<std::uint64_t>(config.strip_ahead)) {
  if (config.l2_ray_ways > 0) ray_ways_.emplace(line_cache(config, config.l2_ray_ways));
}

ShapeCache::ShapeCache(const MemoryConfig& config, std::vector<OwnCache> clients, std::vector<Client> others,
                       Channel<std::uint64_t>& to_memory, Channel<std::uint64_t>& from_memory)
    : ShapeCache(config, std::move(others), to_memory, from_memory) {
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
  out.l2_ray_ways = 0;
  out.l2_answer_bytes_per_cycle = 0;
  return out;
}

void ShapeCache::warm(std::span<const std::uint64_t> lines, double part) {
  for (const std::uint64_t line : lines) {
    const std::uint64_t mixed = (line + 1) * 0x9e3779b97f4a7c15ull,
                        drawn = (mixed ^ (mixed >> 31)) * 0xbf58476d1ce4e5b9ull;
    if (static_cast<double>(drawn >> 11) * 0x1p-53 < part) ways_of(line).insert(line);
  }
}

std::vector<std::uint64_t> ShapeCache::lines() const {
  std::vector<std::uint64_t> lines = cache_.lines();
  if (ray_ways_) {
    const std::vector<std::uint64_t> others = ray_ways_->lines();
    lines.insert(lines.end(), others.begin(), others.end());
  }
  return lines;
}

void ShapeCache::drain(Cycle now) {
  std::vector<std::uint64_t> written;
  cache_.take_written(written);
  if (ray_ways_) ray_ways_->take_written(written);
  std::sort(written.begin(), written.end());
  for (const std::uint64_t line : written) to_memory_.send(now + memory_latency_, kWriteLine | line);
  statistics_.drained += written.size();
}

Cycle ShapeCache::next() const {
  Cycle first = from_memory_.next();
  if (!answers_.empty()) first = std::min(first, answers_.top().ready);
  first = std::min(first, walks_.next());
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
    const std::uint32_t own_caches = static_cast<std::uint32_t>(own_caches_.size());
    for (std::uint32_t c = 0; c < own_caches; ++c) {
      Channel<std::uint64_t>& requests = *own_caches_[c].requests;
      while (requests.next() <= now) take_line(c, requests.take(), now);
      next_ = std::min(next_, requests.next());
    }
    for (std::uint32_t c = 0; c < clients_.size(); ++c) {
      Channel<FetchRequest>& requests = *clients_[c].requests;
      while (requests.next() <= now) take(own_caches + c, requests.take(), now);
      next_ = std::min(next_, requests.next());
    }
    while (walks_.next() <= now)
      if (const std::optional<std::uint32_t> walk = walks_.take()) walk_on(*walk, now);
    next_ = std::min(next_, walks_.next());
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
  const std::uint32_t push = request.others == 0 ? 0 : begin_push(request);
  const std::uint32_t index = begin({client, request.tag, request.lines, 0, 0, request.lines, push});
  ++statistics_.requests;
  statistics_.lines += request.lines;
  if (request.ends_by_flag) {
    const std::uint32_t walk = walks_.begin(request.first_line, request.lines, index);
    pending_[index].walk = walk + 1;
    return walk_on(walk, now);
  }
  for (std::uint32_t i = 0; i < request.lines; ++i) look_up({request.first_line + i, index}, now);
}

/// Looks up the lines of a strip that may be looked up now.
void ShapeCache::walk_on(std::uint32_t walk, Cycle now) {
  while (const std::optional<StripWalks::Line> next = walks_.next_line(walk)) {
    statistics_.past_end += next->past_end;
    statistics_.lines += next->past_end;
    look_up({next->line, next->past_end ? kNobody : walks_.request(walk)}, now);
  }
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
    ways_of(line).touch(line);
    to_memory(take_port(bank_of(line), now), kWriteLine | line);
    ++statistics_.written;
    return;
  }
  look_up({line, (request & kWholeLine) != 0 ? kWholeWriter : kWriter}, now);
  ++statistics_.kept;
}

void ShapeCache::write_through(const FetchRequest& request, Cycle now) {
  for (std::uint64_t i = 0; i < request.lines; ++i) {
    const std::uint64_t line = request.first_line + i;
    ways_of(line).touch(line);
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
  if (bank.waiting.empty() && try_look_up(bank, one, now)) return;
  bank.waiting.push_back(one);
  ++statistics_.mshr_waits;
}

/// Returns whether the line could be looked up.
bool ShapeCache::try_look_up(Bank& bank, const LookUp& one, Cycle now) {
  return one.request >= kWholeWriter ? write(bank, one, now) : read(bank, one, now);
}

/// Looks up a line for a request that waits for it. Returns the end of the cycle in which that is done.
Cycle ShapeCache::looked_up(const LookUp& one, Bank& bank, Cycle now) {
  const Cycle end = take_port(bank, now);
  if (one.request != kNobody) pending_[one.request].ready = std::max(pending_[one.request].ready, end);
  return end;
}

bool ShapeCache::read(Bank& bank, const LookUp& one, Cycle now) {
  if (ways_of(one.line).touch(one.line)) {
    const Cycle end = looked_up(one, bank, now);
    ++statistics_.hits;
    if (one.request == kNobody) return true;
    Pending& pending = pending_[one.request];
    if (pending.walk > 0) [[unlikely]]
      walks_.there(pending.walk - 1, one.line, end);
    if (--pending.lines_missing == 0) complete(one.request);
    return true;
  }
  if (!can_fetch(bank) && !missing_.has(one.line)) return false;
  const Cycle end = looked_up(one, bank, now);
  if (missing_.wait(one.line, one.request)) {
    to_memory(end, one.line);
    ++bank.on_their_way;
    ++statistics_.misses;
    statistics_.past_end_misses += one.request == kNobody;
  } else {
    ++statistics_.merged;
  }
  return true;
}

bool ShapeCache::write(Bank& bank, const LookUp& one, Cycle now) {
  const bool here = ways_of(one.line).touch(one.line);
  if (here || (one.request == kWholeWriter && !missing_.has(one.line))) {
    const Cycle looked_up = take_port(bank, now);
    if (!here) insert(one.line, looked_up);
    ways_of(one.line).written(one.line);
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

std::string ShapeCache::describe() const {
  if (missing_.size() == 0) return "";
  return fmt::format("cache: {} lines on their way from memory", missing_.size());
}

}  // namespace carousel::ringbus::cycle
