#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "ringbus/cycle/rings/ring_end.h"
#include "ringbus/cycle/rings/ring_shape.h"
#include "ringbus/results/stop_ring_use.h"

namespace carousel::ringbus::cycle {

/// What the links of a ring have moved; by the clock of the network.
class RingLinks {
 public:
  struct Use {
    Cycle busy = 0, in_window = 0;
    std::uint64_t packets = 0;
  };

  /// `window`: its begin and its end.
  RingLinks(std::size_t links, std::array<Cycle, 2> window) : window_(window), uses_(links) {}

  /// A link is busy from `at` on. `packet`: with the first flits of one.
  void use(std::size_t link, Cycle at, Cycle cycles, bool packet) {
    Use& use = uses_[link];
    use.busy += cycles;
    use.packets += packet;
    const Cycle begin = std::max(at, window_[0]), end = std::min(at + cycles, window_[1]);
    if (begin < end) use.in_window += end - begin;
  }
  const std::vector<Use>& all() const { return uses_; }

 private:
  std::array<Cycle, 2> window_;
  std::vector<Use> uses_;
};

/// The stops of a ring and the links between them: they are clocked together, so they are one part.
class RingFabric {
 public:
  virtual ~RingFabric() = default;

  /// The first cycle after the last step in which something happens; kNever when all is done.
  virtual Cycle next() const = 0;
  virtual void step(Cycle now) = 0;
  /// What is under way goes round, so that each step counts, even if next() has no answer.
  virtual bool rides() const { return false; }
  /// A place has become free at a stop, after the step of `now`.
  virtual void look_again(Cycle now) { static_cast<void>(now); }

  const RingLinks& links() const { return links_; }
  const StopRingUse& use() const { return use_; }

 protected:
  /// Keeps references to the shape and the ends, by stop.
  RingFabric(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links)
      : shape_(shape), ends_(std::move(ends)), links_(std::move(links)) {}

  const RingShape& shape_;
  std::vector<RingEnd*> ends_;
  RingLinks links_;
  StopRingUse use_;
};

/// The ring of the rule that its drawing names. Keeps references to the shape and the ends.
std::unique_ptr<RingFabric> make_ring(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links);

}  // namespace carousel::ringbus::cycle
