// Lines that come, requests that wait for them, and their answers.
#include <algorithm>
#include <bit>

#include "ringbus/cycle/shapes/shape_cache.h"

namespace carousel::ringbus::cycle {

void ShapeCache::insert(std::uint64_t line, Cycle now) {
  const LineCache::Replaced replaced = ways_of(line).insert(line);
  for (std::uint64_t written = replaced.written; written != 0; written &= written - 1) {
    to_memory(now, kWriteLine | (replaced.first_part + static_cast<std::uint64_t>(std::countr_zero(written))));
    ++statistics_.written_back;
  }
}

void ShapeCache::fill(std::uint64_t line, Cycle now) {
  insert(line, now);
  missing_.come(line, [&](std::uint32_t index) {
    if (index == kWriter) return ways_of(line).written(line);
    if (index == kNobody) return;
    Pending& pending = pending_[index];
    pending.ready = std::max(pending.ready, now);
    if (pending.walk > 0) [[unlikely]]
      walks_.there(pending.walk - 1, line, now);
    if (--pending.lines_missing == 0) complete(index);
  });
  Bank& bank = bank_of(line);
  --bank.on_their_way;
  for (; !bank.waiting.empty(); bank.waiting.pop_front()) {
    const LookUp one = bank.waiting.front();
    if (!try_look_up(bank, one, now)) return;
  }
}

// ---- answers

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
  Cycle arrival = now + answer_latency_;
  if (answer_bytes_ > 0) {
    // One behind the other, each with its tail.
    answers_free_ = std::max(answers_free_, now) + ceil_div(answer.lines * line_bytes_, answer_bytes_);
    arrival = answers_free_ - 1 + answer_latency_;
  }
  if (answer.client < own_caches_.size())
    own_caches_[answer.client].answers->send(arrival, answer.line);
  else
    clients_[answer.client - own_caches_.size()].answers->send(arrival, {answer.tag});
  if (answer.push > 0) [[unlikely]]
    push(answer.push - 1, arrival);
}

/// The request is for others too. Returns 1 + its place among the pushes.
std::uint32_t ShapeCache::begin_push(const FetchRequest& request) {
  if (free_pushes_.empty()) {
    free_pushes_.push_back(static_cast<std::uint32_t>(pushes_.size()));
    pushes_.emplace_back();
  }
  const std::uint32_t index = free_pushes_.back();
  free_pushes_.pop_back();
  pushes_[index] = {{request.first_line * line_bytes_ + request.skipped, request.wanted}, request.others};
  return index + 1;
}

/// One answer on wires that all hear.
void ShapeCache::push(std::uint32_t index, Cycle arrival) {
  for (std::uint64_t clients = pushes_[index].clients; clients != 0; clients &= clients - 1) {
    clients_[static_cast<std::size_t>(std::countr_zero(clients))].pushed->send(arrival, pushes_[index].shapes);
    ++statistics_.pushed;
  }
  free_pushes_.push_back(index);
}

void ShapeCache::complete(std::uint32_t index) {
  const Pending& pending = pending_[index];
  answers_.push({pending.ready, next_turn_++, pending.client, pending.tag, pending.line, pending.lines, pending.push});
  free_pending_.push_back(index);
}

}  // namespace carousel::ringbus::cycle
