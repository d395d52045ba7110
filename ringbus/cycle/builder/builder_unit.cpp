#include "ringbus/cycle/builder/builder_unit.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

BuilderUnit::BuilderUnit(const BuilderConfig& config, const MemoryConfig& memory, const BuilderWork& work,
                         Channel<std::uint64_t>& requests, Channel<std::uint64_t>& answers)
    : port_rate_(static_cast<std::uint64_t>(config.bytes_per_cycle)),
      box_rate_(static_cast<std::uint64_t>(config.boxes_per_cycle)),
      line_bytes_(fetched_bytes(memory)),
      most_requests_(static_cast<std::size_t>(config.requests)),
      box_latency_(static_cast<Cycle>(config.latency_cycles)),
      latency_(MemoryAgent::request_latency(memory)),
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
    const std::vector<std::uint64_t> lines = lines_of(computed.writes);
    for (const std::uint64_t line : lines) to_write_.push_back(line | kWriteLine);
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

BuilderUse run_builder(const BuilderConfig& config, const MemoryConfig& memory, std::int64_t clock_mhz,
                       const BuilderWork& work, const std::stop_token& stop) {
  constexpr std::uint64_t kLookEvery = 1 << 16;  // steps between two looks at the stop token
  constexpr std::uint32_t kUnit = 0, kMemory = 1;
  ChannelList list;
  const std::uint64_t line_bytes = fetched_bytes(memory);
  const MessageKind asks = list.carry({"line requests", "builder", "DRAM", "address wires"}, kAddressBytes);
  const MessageKind lines = list.carry({"lines", "DRAM", "builder", "DRAM's data wires"}, line_bytes);
  Channel<std::uint64_t> down(list.at(asks, {kUnit, kMemory, MemoryAgent::request_latency(memory)}));
  Channel<std::uint64_t> up(list.at(lines, {kMemory, kUnit, MemoryAgent::answer_latency(memory)}));
  const std::unique_ptr<MemoryAgent> dram = make_memory(memory, clock_mhz, {{&down, &up}});
  BuilderUnit unit(config, memory, work, down, up);
  BuilderUse use;
  for (std::uint64_t steps = 0;; ++steps) {
    if (steps % kLookEvery == 0 && stop.stop_requested()) use.complete = false;
    Agent* const first = unit.next() <= dram->next() ? static_cast<Agent*>(&unit) : dram.get();
    if (!use.complete || first->next() == kNever) break;
    first->run(first->next() + 1);
  }
  const bool complete = use.complete;
  use = unit.use();
  use.complete = complete;
  use.cycles = std::max(unit.last_step() + 1, dram->idle_from());
  dram->close(use.cycles);
  use.dram = dram->dram_use(use.cycles);
  const MemoryCounts counts = dram->counts();
  if (complete && (!unit.done() || counts.lines != use.lines_read || counts.lines_written != use.lines_written))
    throw SimulationError(fmt::format("the builder asked for {} lines and wrote {}, the memory counted {} and {}",
                                      use.lines_read, use.lines_written, counts.lines, counts.lines_written));
  return use;
}

}  // namespace carousel::ringbus::cycle
