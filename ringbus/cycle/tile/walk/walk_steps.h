#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/structure/node.h"
#include "core/types/unit_kind.h"
#include "ringbus/cycle/testers/unit_passes.h"

namespace carousel::ringbus::cycle {

/// A strip that a ray comes to, and its tests there. Rays read their ways from far and wide in the host's memory, so a
/// step is short: most strips need passes of one kind alone, which stand in it. Others stand apart (WalkSteps).
class WalkStep {
 public:
  WalkStep(accel::NodeKey strip, std::uint16_t passes) : key(strip), tests_(passes) {}
  /// Passes of several kinds, by their place.
  WalkStep(accel::NodeKey strip, std::size_t place)
      : key(strip), tests_(kSeveral | static_cast<std::uint32_t>(place)) {}

  /// The kind of most strips of this sort.
  static UnitKind kind_at(accel::NodeRef strip) {
    if (strip.is_inner()) return UnitKind::kBox;
    return strip.is_procedural() ? UnitKind::kProcedural : UnitKind::kTriangle;
  }
  bool has_one_kind() const { return (tests_ & kSeveral) == 0; }
  UnitKind kind() const { return kind_at(key.ref); }
  std::uint32_t passes() const { return tests_; }
  std::uint32_t place() const { return tests_ & ~kSeveral; }

  accel::NodeKey key;

 private:
  static constexpr std::uint32_t kSeveral = std::uint32_t{1} << 31;
  std::uint32_t tests_;
};
static_assert(sizeof(WalkStep) == sizeof(accel::NodeKey) + 4);

/// The ways of a visit's rays, one behind the other.
class WalkSteps {
 public:
  void clear() {
    steps_.clear();
    ends_.clear();
    several_.clear();
  }
  /// A ray's next strip. `before`, `after`: ray_tests() of all strips until then, with an inversion wherever the ray
  /// needs one, also if another ray's will do.
  void add(accel::NodeKey strip, const RayTests& before, const RayTests& after) {
    const UnitKind kind = WalkStep::kind_at(strip.ref);
    RayTests others = after;
    others.tests[kind] = before.tests[kind];
    if (others == before) {
      steps_.emplace_back(strip, static_cast<std::uint16_t>(after.tests[kind] - before.tests[kind]));
    } else {
      steps_.emplace_back(strip, several_.size());
      several_.push_back(after.since(before));
    }
  }
  void end_ray() { ends_.push_back(static_cast<std::uint32_t>(steps_.size())); }

  const WalkStep& operator[](std::uint32_t i) const { return steps_[i]; }
  /// By ray: the end of its steps.
  const std::vector<std::uint32_t>& ends() const { return ends_; }
  /// The tests of a step that has several kinds.
  const RayTests& tests(const WalkStep& step) const { return several_[step.place()]; }
  /// The ray is brought to model space there.
  bool transforms(const WalkStep& step) const {
    return !step.has_one_kind() && tests(step).tests[UnitKind::kTransform] > 0;
  }

 private:
  std::vector<WalkStep> steps_;
  std::vector<std::uint32_t> ends_;
  std::vector<RayTests> several_;
};

}  // namespace carousel::ringbus::cycle
