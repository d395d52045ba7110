#include "ringbus/cycle/shapes/shape_cache.h"

#include <algorithm>
#include <bit>
#include <optional>

#include <fmt/format.h>

#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/results/class_use.h"
#include "ringbus/results/memory_request.h"

namespace carousel::ringbus::cycle {

Cycle ShapeCache::request_latency(const MemoryConfig& config) {
  return way_there(config.l2_latency_cycles);
}

Cycle ShapeCache::answer_latency(const MemoryConfig& config) {
  return way_back(config.l2_latency_cycles);
}

ShapeCache::ShapeCache(const MemoryConfig& config, std::vector<Client> clients, Channel<std::uint64_t>& to_memory,
                       Channel<std::uint64_t>& from_memory)
    : ShapeCache(config, {}, std::move(clients), to_memory, from_memory) {}

ShapeCache::ShapeCache(const MemoryConfig& config, std::vector<OwnCache> clients, std::vector<Client> others,
                       Channel<std::uint64_t>& to_memory, Channel<std::uint64_t>& from_memory)
    : line_bytes_(fetched_bytes(config)),
      writes_back_(config.l2_write == MemoryConfig::Write::kBack),
      own_caches_(std::move(clients)),
      clients_(std::move(others)),
      from_memory_(from_memory),
      tags_(config),
      banks_(config, statistics_),
      pending_(static_cast<std::uint64_t>(config.strip_ahead)),
      to_memory_(to_memory, MemoryAgent::request_latency(config),
                 config.l2_banks == 1 && !writes_back_ && config.translation.page_bytes == 0),
      pages_(config.translation.page_bytes, config.translation.entries),
      lines_per_cycle_(static_cast<std::uint64_t>(config.l2_lines_per_cycle * config.l2_banks)),
      answers_(config, own_caches_, clients_, statistics_) {}

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
  out.translation.page_bytes = 0;
  return out;
}

void ShapeCache::warm(std::span<const std::uint64_t> lines, double from, double to) {
  for (const std::uint64_t line : lines.last(std::min<std::size_t>(lines.size(), tags_.room()))) {
    const double at = WarmCaches::drawn(line);
    if (from <= at && at < to) tags_.insert(line);
  }
}

void ShapeCache::drain(Cycle now) {
  const std::vector<std::uint64_t> written = tags_.take_written();
  for (const std::uint64_t line : written) to_memory_.send(now, kWriteLine | line);
  statistics_.drained += written.size();
}

// ---- time

Cycle ShapeCache::next() const {
  Cycle first = std::min({from_memory_.next(), answers_.next(), pending_.walks().next(), to_memory_.next()});
  for (const Client& client : clients_) first = std::min(first, client.requests->next());
  for (const OwnCache& client : own_caches_) first = std::min(first, client.requests->next());
  return first;
}

void ShapeCache::run(Cycle end) {
  for (next_ = next(); next_ < end;) {
    const Cycle now = next_;
    while (from_memory_.next() <= now) {
      const std::uint64_t line = from_memory_.take();
      if (line * line_bytes_ >= kPageTables)
        take_entry(now);
      else
        fill(line, now);
    }
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
    while (pending_.walks().next() <= now)
      if (const std::optional<std::uint32_t> walk = pending_.walks().take()) walk_on(*walk, now);
    next_ = std::min(next_, pending_.walks().next());
    answers_.send_due(now);
    next_ = std::min(next_, answers_.next());
    to_memory_.send_due(now);
    next_ = std::min(next_, to_memory_.next());
  }
}

// ---- requests

void ShapeCache::take(std::uint32_t client, const FetchRequest& request, Cycle now) {
  if (request.written > 0) [[unlikely]]
    return take_write(request, now);
  if (request.ahead) [[unlikely]]
    return fetch_ahead(request, now);
  const std::uint32_t push = request.others == 0 ? 0 : answers_.begin_push(request);
  const std::uint32_t index = pending_.begin({client, request.tag, request.lines, 0, 0, request.lines, push});
  ++statistics_.requests;
  statistics_.lines += request.lines;
  if (request.ends_by_flag) return walk_on(pending_.begin_walk(index, request.first_line), now);
  for (std::uint32_t i = 0; i < request.lines; ++i) look_up({request.first_line + i, index}, now);
}

/// A request of an own cache.
void ShapeCache::take_line(std::uint32_t client, std::uint64_t request, Cycle now) {
  const std::uint64_t line = request & ~(kWriteLine | kWholeLine);
  if ((request & kWriteLine) == 0) {
    ++statistics_.requests;
    ++statistics_.lines;
    return look_up({line, pending_.begin({client, 0, 1, 0, line})}, now);
  }
  if (!writes_back_) return write_through(line, false, now);
  look_up({line, (request & kWholeLine) != 0 ? kWholeWriter : kWriter}, now);
  ++statistics_.kept;
}

void ShapeCache::take_write(const FetchRequest& request, Cycle now) {
  for (std::uint64_t i = 0; i < request.lines; ++i) {
    const std::uint64_t line = request.first_line + i;
    const bool whole = writes_whole(request, i);
    if (writes_back_)
      look_up({line, whole ? kWholeWriter : kWriter}, now);
    else
      write_through(line, asks_a_cache_ && whole, now);
  }
  if (writes_back_) statistics_.kept += request.lines;
}

void ShapeCache::fetch_ahead(const FetchRequest& request, Cycle now) {
  for (std::uint64_t line = request.first_line; line < request.first_line + request.lines; ++line) {
    CacheBank& bank = banks_.of(line);
    ++ahead_.asked;
    if (!bank.waiting.empty()) {
      ++ahead_.dropped;
      continue;
    }
    const Cycle leaves = banks_.take_port(bank, now);
    if (tags_.touch(line) || missing_.has(line)) {
      ++ahead_.found;
    } else if (!banks_.can_fetch(bank)) {
      ++ahead_.dropped;
    } else {
      missing_.wait(line, kNobody);
      ask_memory(leaves, line);
      ++bank.on_their_way;
      ++ahead_.fetched;
    }
  }
}

/// Returns whether the request writes all of its i-th line.
bool ShapeCache::writes_whole(const FetchRequest& request, std::uint64_t i) const {
  return (i > 0 || request.skipped == 0) && (i + 1) * line_bytes_ <= std::uint64_t{request.skipped} + request.written;
}

/// The line goes on to memory. `whole`: the L2 behind this cache is told that all of it is written.
void ShapeCache::write_through(std::uint64_t line, bool whole, Cycle now) {
  tags_.touch(line);
  ask_memory(banks_.take_port(banks_.of(line), now), kWriteLine | line | (whole ? kWholeLine : 0));
  ++statistics_.written;
}

/// Looks up the lines of a strip that may be looked up now.
void ShapeCache::walk_on(std::uint32_t walk, Cycle now) {
  StripWalks& walks = pending_.walks();
  while (const std::optional<StripWalks::Line> next = walks.next_line(walk)) {
    statistics_.past_end += next->past_end;
    statistics_.lines += next->past_end;
    look_up({next->line, next->past_end ? kNobody : walks.request(walk)}, now);
  }
}

// ---- look-ups

/// Looks up a line, unless its bank has stopped at one before it or stops at this one.
void ShapeCache::look_up(const LineLookUp& one, Cycle now) {
  CacheBank& bank = banks_.of(one.line);
  if (bank.waiting.empty() && try_look_up(bank, one, now)) return;
  bank.waiting.push_back(one);
  ++statistics_.mshr_waits;
}

/// Returns whether the line could be looked up.
bool ShapeCache::try_look_up(CacheBank& bank, const LineLookUp& one, Cycle now) {
  return one.request >= kWholeWriter ? write(bank, one, now) : read(bank, one, now);
}

bool ShapeCache::read(CacheBank& bank, const LineLookUp& one, Cycle now) {
  if (tags_.touch(one.line)) {
    const Cycle end = banks_.take_port(bank, now);
    ++statistics_.hits;
    if (one.request != kNobody) line_there(one.request, one.line, end);
    return true;
  }
  if (!banks_.can_fetch(bank) && !missing_.has(one.line)) return false;
  const Cycle end = banks_.take_port(bank, now);
  if (one.request != kNobody) pending_.looked_up(one.request, end);
  if (missing_.wait(one.line, one.request)) {
    ask_memory(end, one.line);
    ++bank.on_their_way;
    ++statistics_.misses;
    statistics_.past_end_misses += one.request == kNobody;
  } else {
    ++statistics_.merged;
  }
  return true;
}

bool ShapeCache::write(CacheBank& bank, const LineLookUp& one, Cycle now) {
  const bool here = tags_.touch(one.line);
  if (here || (one.request == kWholeWriter && !missing_.has(one.line))) {
    const Cycle looked_up = banks_.take_port(bank, now);
    if (!here) insert(one.line, looked_up);
    tags_.written(one.line);
    return true;
  }
  if (!banks_.can_fetch(bank) && !missing_.has(one.line)) return false;
  const Cycle looked_up = banks_.take_port(bank, now);
  if (missing_.wait(one.line, kWriter)) {
    ask_memory(looked_up, one.line);
    ++bank.on_their_way;
    ++statistics_.write_fetches;
  }
  return true;
}

// ---- lines that come

/// The lines that the line replaces and that have been written go to memory.
void ShapeCache::insert(std::uint64_t line, Cycle now) {
  const LineCache::Replaced replaced = tags_.insert(line);
  for (std::uint64_t written = replaced.written; written != 0; written &= written - 1) {
    ask_memory(now, kWriteLine | (replaced.first_part + static_cast<std::uint64_t>(std::countr_zero(written))));
    ++statistics_.written_back;
  }
}

/// A line comes from memory: requests that wait for it have it, and its bank may go on.
void ShapeCache::fill(std::uint64_t line, Cycle now) {
  insert(line, now);
  missing_.come(line, [&](std::uint32_t index) {
    if (index == kWriter)
      tags_.written(line);
    else if (index != kNobody)
      line_there(index, line, now);
  });
  CacheBank& bank = banks_.of(line);
  --bank.on_their_way;
  for (; !bank.waiting.empty(); bank.waiting.pop_front()) {
    const LineLookUp one = bank.waiting.front();
    if (!try_look_up(bank, one, now)) return;
  }
}

/// A line of a request will be there `at` this time, or is. The request is answered when its last line is.
void ShapeCache::line_there(std::uint32_t index, std::uint64_t line, Cycle at) {
  if (!pending_.there(index, line, at)) return;
  const PendingRequests::Request& request = pending_[index];
  answers_.add({request.ready, request.client, request.tag, request.line, request.lines, request.push});
  pending_.end(index);
}

// ---- pages

/// The request goes to the memory when it leaves, and the page of its line is known.
void ShapeCache::ask_memory(Cycle leaves, std::uint64_t request) {
  if (!pages_.on()) return to_memory_.add(leaves, request);
  using Found = Translator<Leaving>::Found;
  ++statistics_.pages;
  const Found found = pages_.look_up((request & ~(kWriteLine | kWholeLine)) * line_bytes_, {leaves, request});
  if (found == Found::kHere) return to_memory_.add(leaves, request);
  ++statistics_.page_misses;
  if (found == Found::kWalks) read_entry(leaves);
}

/// The walker reads the next level for its page.
void ShapeCache::read_entry(Cycle now) {
  if (pages_.begins()) ++statistics_.walks;
  ++statistics_.walk_reads;
  to_memory_.add(now, (kPageTables + pages_.entry()) / line_bytes_);
}

void ShapeCache::take_entry(Cycle now) {
  if (const std::optional<std::vector<Leaving>> waited = pages_.take())
    for (std::uint64_t i = 0; i < waited->size(); ++i) {
      const Leaving& line = (*waited)[i];
      const Cycle leaves = std::max(line.at, now + i / lines_per_cycle_);
      statistics_.page_waits += leaves - line.at;
      to_memory_.add(leaves, line.request);
    }
  if (pages_.walks()) read_entry(now);
}

std::string ShapeCache::describe() const {
  if (missing_.size() == 0) return "";
  return fmt::format("cache: {} lines on their way from memory", missing_.size());
}

}  // namespace carousel::ringbus::cycle
