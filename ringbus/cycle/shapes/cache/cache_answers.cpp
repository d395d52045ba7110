#include "ringbus/cycle/shapes/cache/cache_answers.h"

#include <algorithm>
#include <bit>

namespace carousel::ringbus::cycle {

CacheAnswers::CacheAnswers(const MemoryConfig& config, const std::vector<OwnCacheClient>& own_caches,
                           const std::vector<CacheClient>& clients, CacheCounts& counts)
    : own_caches_(own_caches),
      clients_(clients),
      counts_(counts),
      latency_(way_back(config.l2_latency_cycles)),
      line_bytes_(fetched_bytes(config)),
      bytes_per_cycle_(static_cast<std::uint64_t>(config.l2_answer_bytes_per_cycle)) {}

std::uint32_t CacheAnswers::begin_push(const FetchRequest& request) {
  return 1 + pushes_.take({{request.first_line * line_bytes_ + request.skipped, request.wanted}, request.others});
}

void CacheAnswers::send(const Answer& answer, Cycle now) {
  Cycle arrival = now + latency_;
  if (bytes_per_cycle_ > 0) {
    // One behind the other, each with its tail.
    wires_free_ = std::max(wires_free_, now) + ceil_div(answer.lines * line_bytes_, bytes_per_cycle_);
    arrival = wires_free_ - 1 + latency_;
  }
  if (answer.client < own_caches_.size())
    own_caches_[answer.client].answers->send(arrival, answer.line);
  else
    clients_[answer.client - own_caches_.size()].answers->send(
        arrival, {answer.tag, static_cast<std::uint32_t>(answer.lines * line_bytes_)});
  if (answer.push > 0) [[unlikely]]
    send_push(answer.push - 1, arrival);
}

/// The others get one answer, on wires that all of them hear.
void CacheAnswers::send_push(std::uint32_t index, Cycle arrival) {
  for (std::uint64_t clients = pushes_[index].clients; clients != 0; clients &= clients - 1) {
    clients_[static_cast<std::size_t>(std::countr_zero(clients))].pushed->send(arrival, pushes_[index].shapes);
    ++counts_.pushed;
  }
  pushes_.give_back(index);
}

}  // namespace carousel::ringbus::cycle
