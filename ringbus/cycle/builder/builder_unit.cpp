#include "ringbus/cycle/builder/builder_unit.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

BuilderUnit::BuilderUnit(const BuilderConfig& config, const MemoryConfig& memory, const BuilderWork& work,
                         Cycle latency, Channel<std::uint64_t>& requests, Channel<std::uint64_t>& answers)
    : port_rate_(static_cast<std::uint64_t>(config.bytes_per_cycle)),
      box_rate_(static_cast<std::uint64_t>(config.boxes_per_cycle)),
      line_bytes_(fetched_bytes(memory)),
      asks_l2_(config.asks == BuilderConfig::Asks::kL2),
      most_requests_(static_cast<std::size_t>(config.requests)),
      box_latency_(static_cast<Cycle>(config.latency_cycles)),
      latency_(latency),
      work_(work),
      requests_(requests),
      answers_(answers) {
  begin_level();
}

/// A level without tasks takes no time.
void BuilderUnit::begin_level() {
  while (!done() && work_.levels[level_].empty()) ++level_;
  next_task_ = written_tasks_ = 0;
  if (done()) return;
  ++use_.levels;
  waits_.assign(work_.levels[level_].size(), 0);
}

bool BuilderUnit::may_send() const {
  if (!to_write_.empty()) return true;
  return under_way_ < most_requests_ && (!to_read_.empty() || (!done() && next_task_ < work_.levels[level_].size()));
}

Cycle BuilderUnit::next() const {
  Cycle first = answers_.next();
  if (!computed_.empty()) first = std::min(first, computed_.front().at);
  if (may_send()) first = std::min(first, port_ / port_rate_);
  return first == kNever ? kNever : std::max(first, now_);
}

void BuilderUnit::run(Cycle end) {
  for (Cycle at = next(); at < end; at = next()) step(at);
}

void BuilderUnit::step(Cycle now) {
  now_ = now;
  while (answers_.next() <= now) take_answer(answers_.take());
  for (; !computed_.empty() && computed_.front().at <= now; computed_.pop_front()) {
    const BuilderTask& computed = task(computed_.front().task);
    const std::vector<std::uint64_t> lines = writes_of(computed);
    to_write_.insert(to_write_.end(), lines.begin(), lines.end());
    use_.lines_written += lines.size();
    if (computed.top) use_.top_lines += lines.size();
    ++written_tasks_;
  }
  while (may_send() && port_ / port_rate_ <= now) {
    if (!to_write_.empty()) {
      send(to_write_.front());
      to_write_.pop_front();
      continue;
    }
    if (to_read_.empty()) {
      const std::size_t number = next_task_++;
      const std::vector<std::uint64_t> lines = lines_of(task(number).reads);
      to_read_.assign(lines.begin(), lines.end());
      waits_[number] = lines.size();
      use_.lines_read += lines.size();
      if (task(number).top) use_.top_lines += lines.size();
      for (const std::uint64_t line : lines) asked_[line].push_back(number);
      if (lines.empty()) compute(number);
      continue;
    }
    send(to_read_.front());
    to_read_.pop_front();
    ++under_way_;
  }
  if (!done() && written_tasks_ == work_.levels[level_].size() && to_write_.empty()) {
    ++level_;
    begin_level();
  }
}

void BuilderUnit::send(std::uint64_t request) {
  port_ = std::max(port_, now_ * port_rate_) + line_bytes_;
  requests_.send(now_ + latency_, request);
}

void BuilderUnit::take_answer(std::uint64_t line) {
  const auto asked = asked_.find(line);
  const std::size_t number = asked->second.front();
  asked->second.pop_front();
  if (asked->second.empty()) asked_.erase(asked);
  --under_way_;
  if (--waits_[number] == 0) compute(number);
}

void BuilderUnit::compute(std::size_t number) {
  boxes_ = std::max(boxes_, now_ * box_rate_) + task(number).boxes;
  use_.boxes += task(number).boxes;
  computed_.push_back({ceil_div(boxes_, box_rate_) + box_latency_ - 1, number});
}

std::vector<std::uint64_t> BuilderUnit::lines_of(const std::vector<ShapeSpan>& spans) const {
  std::vector<std::uint64_t> out;
  for (const ShapeSpan& span : spans)
    for (std::uint64_t line = span.address / line_bytes_; line * line_bytes_ < span.address + span.bytes; ++line)
      out.push_back(line);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Requests to write all lines that the task writes. An L2 is told of which it writes all bytes.
std::vector<std::uint64_t> BuilderUnit::writes_of(const BuilderTask& task) const {
  std::vector<std::uint64_t> out = lines_of(task.writes);
  std::unordered_map<std::uint64_t, std::uint64_t> bytes;  // by line
  if (asks_l2_)
    for (const ShapeSpan& span : task.writes)
      for (std::uint64_t line = span.address / line_bytes_; line * line_bytes_ < span.address + span.bytes; ++line)
        bytes[line] +=
            std::min(span.address + span.bytes, (line + 1) * line_bytes_) - std::max(span.address, line * line_bytes_);
  for (std::uint64_t& line : out) line |= kWriteLine | (asks_l2_ && bytes.at(line) >= line_bytes_ ? kWholeLine : 0);
  return out;
}

namespace {

/// The builder, the memory, and an L2 between them if it asks one.
class BuilderMachine {
 public:
  BuilderMachine(const BuilderConfig& config, const MemoryConfig& memory, std::int64_t clock_mhz,
                 const BuilderWork& work, const std::vector<std::uint64_t>& cached) {
    constexpr std::uint32_t kUnit = 0, kMemory = 1, kCache = 2;
    const bool asks_l2 = config.asks == BuilderConfig::Asks::kL2;
    const MessageKind asks = list_.carry({"line requests", "builder", "DRAM", "address wires"}, kAddressBytes);
    const MessageKind lines = list_.carry({"lines", "DRAM", "builder", "DRAM's data wires"}, fetched_bytes(memory));
    const Cycle there = MemoryAgent::request_latency(memory), back = MemoryAgent::answer_latency(memory);
    const std::uint32_t asker = asks_l2 ? kCache : kUnit;
    down_.emplace(list_.at(asks, {asker, kMemory, there}));
    up_.emplace(list_.at(lines, {kMemory, asker, back}));
    dram_ = make_memory(memory, clock_mhz, {{&*down_, &*up_}});
    if (!asks_l2) {
      unit_.emplace(config, memory, work, there, *down_, *up_);
      return;
    }
    const Cycle to_l2 = ShapeCache::request_latency(memory);
    to_l2_.emplace(list_.at(asks, {kUnit, kCache, to_l2}));
    from_l2_.emplace(list_.at(lines, {kCache, kUnit, ShapeCache::answer_latency(memory)}));
    l2_.emplace(memory, std::vector<ShapeCache::OwnCache>{{&*to_l2_, &*from_l2_}}, std::vector<ShapeCache::Client>{},
                *down_, *up_);
    l2_->warm(cached, 0, 1);
    unit_.emplace(config, memory, work, to_l2, *to_l2_, *from_l2_);
  }

  /// Returns false if it was stopped.
  bool run(const std::stop_token& stop) {
    constexpr std::uint64_t kLookEvery = 1 << 16;  // steps between two looks at the stop token
    for (std::uint64_t steps = 0;; ++steps) {
      if (steps % kLookEvery == 0 && stop.stop_requested()) return false;
      Agent* first = &*unit_;
      if (l2_ && l2_->next() < first->next()) first = &*l2_;
      if (dram_->next() < first->next()) first = dram_.get();
      if (first->next() == kNever) return true;
      first->run(first->next() + 1);
    }
  }

  /// Lines that were written and are still in the L2 go to the memory, when all else is there.
  void drain() {
    if (!l2_) return;
    l2_->drain(std::max({unit_->last_step() + 1, dram_->last_step(), dram_->idle_from()}));
    dram_->run(kNever);
  }

  BuilderUse use(bool complete) {
    BuilderUse use = unit_->use();
    use.complete = complete;
    use.cycles = std::max(unit_->last_step() + 1, dram_->idle_from());
    dram_->close(use.cycles);
    use.dram = dram_->dram_use(use.cycles);
    use.memory = dram_->counts();
    if (l2_) use.l2 = l2_->statistics();
    if (complete && !closes(use))
      throw SimulationError(fmt::format("the builder asked for {} lines and wrote {}, the memory counted {} and {}",
                                        use.lines_read, use.lines_written, use.memory.lines, use.memory.lines_written));
    return use;
  }
  std::vector<std::uint64_t> cached() const { return l2_->lines(); }

 private:
  bool closes(const BuilderUse& use) const {
    if (!unit_->done()) return false;
    if (!use.l2) return use.memory.lines == use.lines_read && use.memory.lines_written == use.lines_written;
    const CacheCounts& l2 = *use.l2;
    return l2.lines == use.lines_read && l2.hits + l2.merged + l2.misses == l2.lines &&
           l2.written + l2.kept == use.lines_written &&
           l2.misses + l2.write_fetches + l2.walk_reads == use.memory.lines &&
           l2.written + l2.written_back + l2.drained == use.memory.lines_written;
  }

  ChannelList list_;
  std::optional<Channel<std::uint64_t>> down_, up_, to_l2_, from_l2_;
  std::unique_ptr<MemoryAgent> dram_;
  std::optional<ShapeCache> l2_;
  std::optional<BuilderUnit> unit_;
};

}  // namespace

BuilderUse run_builder(const BuilderConfig& config, const MemoryConfig& memory, std::int64_t clock_mhz,
                       const BuilderWork& work, const std::stop_token& stop, std::vector<std::uint64_t>& cached) {
  BuilderMachine machine(config, memory, clock_mhz, work, cached);
  const bool complete = machine.run(stop);
  if (complete) machine.drain();
  if (config.asks == BuilderConfig::Asks::kL2) cached = complete ? machine.cached() : std::vector<std::uint64_t>{};
  return machine.use(complete);
}

}  // namespace carousel::ringbus::cycle
