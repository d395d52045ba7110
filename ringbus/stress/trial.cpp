#include "ringbus/stress/trial.h"

#include <fmt/format.h>
#include <malloc.h>

#include "ringbus/stress/single_thread_check.h"
#include "ringbus/stress/trials.h"

namespace carousel::ringbus::stress {

namespace {

std::size_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

template <std::size_t kBytes>
TrialResult run_sized(const QueueUnderTest& queue, const TrialOptions& options) {
  const std::size_t capacity = options.pattern == Pattern::kCapacity1   ? 1
                               : options.pattern == Pattern::kCapacity2 ? 2
                                                                        : options.capacity;
  const std::size_t before = heap_bytes();
  const auto alone = queue.make<kBytes>()(capacity);
  Violations found = check_single_thread(*alone, capacity);
  const std::size_t after = heap_bytes();
  TrialResult out;
  switch (options.pattern) {
    case Pattern::kPingPong:
      out = run_ping_pong<kBytes>(queue, options);
      break;
    case Pattern::kCirculation:
      out = run_circulation<kBytes>(queue, options);
      break;
    default:
      out = run_stream<kBytes>(queue, options);
  }
  found += out.violations;
  out.violations = std::move(found);
  out.memory_bytes = after > before ? after - before : 0;
  return out;
}

}  // namespace

void note_ending(Violations& violations, WorkerGroup::Ending ending, const TrialOptions& options) {
  if (ending == WorkerGroup::Ending::kDone) return;
  violations.stuck = true;
  if (!violations.detail.empty()) violations.detail += "; ";
  violations.detail += ending == WorkerGroup::Ending::kStuck
                           ? fmt::format("nothing moved for {} ms", options.stuck_after.count())
                           : fmt::format("a call had not returned after {} ms", 2 * options.stuck_after.count());
}

bool pattern_fits(const QueueUnderTest& queue, Pattern pattern) {
  return pattern != Pattern::kManyToMany || (queue.producers == Parties::kMany && queue.consumers == Parties::kMany);
}

TrialResult run_trial(const QueueUnderTest& queue, const TrialOptions& options) {
  switch (options.message_bytes) {
    case kSmall:
      return run_sized<kSmall>(queue, options);
    case kLine:
      return run_sized<kLine>(queue, options);
    default:
      return run_sized<kPacket>(queue, options);
  }
}

}  // namespace carousel::ringbus::stress
