#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/statistics/cache_counts.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/shapes/cache/cache_clients.h"
#include "ringbus/cycle/shapes/cache/index_pool.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The answers of a cache to its clients, which leave at their times. With `memory.l2_answer_bytes_per_cycle` they
/// share wires, on which one follows the other. An answer to a request that names other clients goes to these too: it
/// is pushed.
class CacheAnswers {
 public:
  /// An answer that leaves at `ready`. Among answers that leave at one time the one that was complete first goes first.
  struct Answer {
    Cycle ready = 0;
    std::uint32_t client = 0, tag = 0;
    std::uint64_t line = 0;   ///< the line that an own cache has asked for
    std::uint32_t lines = 1;  ///< lines in the answer
    std::uint32_t push = 0;   ///< of begin_push(); 0: the answer is for the client alone
  };

  /// Keeps references. Clients are numbered, the own caches before the others. Counts in `counts` what it pushes.
  CacheAnswers(const MemoryConfig& config, const std::vector<OwnCacheClient>& own_caches,
               const std::vector<CacheClient>& clients, CacheCounts& counts);

  /// The request is for others too. Returns the number of its push.
  std::uint32_t begin_push(const FetchRequest& request);
  void add(const Answer& answer) { answers_.push({answer, next_turn_++}); }
  /// The time at which the next answer leaves.
  Cycle next() const { return answers_.empty() ? kNever : answers_.top().answer.ready; }
  /// Sends all that leave by `now`.
  void send_due(Cycle now) {
    for (; !answers_.empty() && answers_.top().answer.ready <= now; answers_.pop()) send(answers_.top().answer, now);
  }

 private:
  struct Outgoing {
    Answer answer;
    std::uint64_t turn = 0;
    bool operator>(const Outgoing& o) const {
      return answer.ready != o.answer.ready ? answer.ready > o.answer.ready : turn > o.turn;
    }
  };
  struct Push {
    PushedShapes shapes;
    std::uint64_t clients = 0;  // a bit each
  };

  void send(const Answer& answer, Cycle now);
  void send_push(std::uint32_t index, Cycle arrival);

  const std::vector<OwnCacheClient>& own_caches_;
  const std::vector<CacheClient>& clients_;
  CacheCounts& counts_;
  Cycle latency_;
  std::uint64_t line_bytes_;
  std::uint64_t bytes_per_cycle_;  // 0: no limit
  Cycle wires_free_ = 0;           // the wires are taken up to this cycle
  std::priority_queue<Outgoing, std::vector<Outgoing>, std::greater<>> answers_;
  std::uint64_t next_turn_ = 0;
  IndexPool<Push> pushes_;
};

}  // namespace carousel::ringbus::cycle
