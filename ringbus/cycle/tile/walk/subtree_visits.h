#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/walk/subtree_walk.h"
#include "ringbus/cycle/tile/walk/walk_time.h"
#include "ringbus/time/event_wheel.h"

namespace carousel::ringbus::cycle {

/// Lets the rays of treelet visits follow their ways under the clock, each by itself: a ray takes the strip that it has
/// come to, is tested when the strip is there, behind the rays that were ready before it, gives the strip back, and
/// goes to the next one. It knows no strip before its tests of the one before have ended. The rays of a visit begin
/// in the packet's order when their records have been read. The visit ends with its last ray.
///
/// In a treelet of the whole tree a ray takes the whole of it once and keeps it to its end, unless the visit has it.
class SubtreeVisits {
 public:
  /// Keeps references. Rays are users of `shapes` from `first_user` on. `timed`: times() are wanted.
  SubtreeVisits(const ShapeMemory& memory, ShapeBuffer& shapes, Tester& tester, std::size_t contexts,
                ShapeBuffer::User first_user, bool timed)
      : memory_(memory),
        shapes_(shapes),
        tester_(tester),
        visits_(contexts),
        left_(contexts),
        first_user_(first_user),
        timed_(timed) {}

  /// Takes away the ways of the rays of a packet, which is in test context `context`.
  void prepare(std::size_t context, WalkSteps& ways);
  /// Starts them. `reads`: the records that the visit reads; those of its rays are the last. `loaded`: the context has
  /// all that they need, to the end of the visit.
  void begin(std::size_t context, std::uint32_t reads, Cycle now, bool loaded);
  bool ended(std::size_t context) const { return left_[context] == 0; }
  /// What its rays did, in their order, when it has ended; nothing where that is not wanted.
  std::span<const WalkTime> times(std::size_t context) const { return visits_[context].times; }
  /// Forgets the visit, which has begun.
  void drop(std::size_t context, Cycle now);

  /// The time at which the next ray begins or has been tested.
  Cycle next() const { return events_.next(); }
  /// Lets rays go on at `now`.
  void run(Cycle now);
  /// Lets rays go on before `limit`, up to the first time at which testing() changes or there is something for the
  /// resource to do, which it returns; kNever if there was none.
  Cycle run_before(Cycle limit);
  /// Tells whether a visit has ended, data has come for others(), or anything has changed for the issue queue, since
  /// forget_news().
  bool has_news() const { return visit_ended_ || !others_.empty() || shapes_.queue_has_changed(); }
  void forget_news() {
    visit_ended_ = false;
    shapes_.forget_changes();
  }
  /// Starts the tests of rays whose data has come. The other users for whom ShapeBuffer::ready() waits go to `others`.
  void serve(Cycle now);
  std::vector<ShapeBuffer::User>& others() { return others_; }

  /// Any ray is in test.
  bool testing() const { return in_test_ > 0; }

 private:
  struct Ray {
    std::uint32_t step = 0, end = 0;
    std::uint32_t context = 0, place = 0;  // in its visit
    enum class Phase : std::uint8_t { kFree, kBegins, kWaits, kInTest, kDropped } phase = Phase::kFree;
  };
  struct Inverted {
    std::uint32_t instance = 0;
    Cycle at = 0;
  };
  struct Visit {
    WalkSteps ways;
    std::vector<WalkTime> times;  // by ray, if they are wanted
    bool loaded = false;
    std::vector<Inverted> inverted;  // matrices, and when
  };

  std::uint32_t new_ray();
  void advance(std::uint32_t index, Cycle now);
  bool has_next(const Ray& ray) const { return ray.step != ray.end; }
  void test(std::uint32_t index, Cycle now);
  Cycle test_several(Visit& visit, const WalkStep& step, Cycle now);

  const ShapeMemory& memory_;
  ShapeBuffer& shapes_;
  Tester& tester_;
  std::vector<Visit> visits_;        // by context
  std::vector<std::uint32_t> left_;  // likewise: rays that have not ended
  ShapeBuffer::User first_user_;
  bool timed_;
  std::vector<Ray> rays_;
  std::vector<std::uint32_t> free_rays_;
  std::vector<ShapeBuffer::User> others_;
  EventWheel events_;
  std::size_t in_test_ = 0;
  bool visit_ended_ = false;
};

}  // namespace carousel::ringbus::cycle
