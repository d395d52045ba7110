#pragma once

#include <algorithm>
#include <cstdint>

#include "core/config/fields/cull_planes.h"
#include "ringbus/cycle/testers/bank_overlap.h"
#include "ringbus/cycle/testers/unit_bank.h"

namespace carousel::ringbus::cycle {

/// The way of a single ray through units of each kind (core/types/unit_kind.h): to model space, then boxes and planes,
/// beside primitives of all kinds, their micromaps, their opacity and the sorted buffers of hits. Compressed
/// primitives are decoded first.
struct RayStages {
  CullPlanesConfig::Order order = CullPlanesConfig::Order::kBoxFirst;
  bool inline_any_hit = true;

  /// The last answer to `starts` tests of each kind, the first at `at`, beside the tests of others. Answers that come
  /// one after another are noted in `overlap`.
  Cycle through(PerUnit<UnitBank>& units, Cycle at, const PerUnit<std::uint64_t>& starts, BankOverlap& overlap) const {
    const auto beside = [&](UnitKind kind, Cycle from) {
      return starts[kind] == 0 ? from : units[kind].reserve_beside(from, starts[kind]).last;
    };
    const Cycle moved = beside(UnitKind::kTransform, at);
    const bool planes_first = order == CullPlanesConfig::Order::kPlanesFirst && starts[UnitKind::kPlane] > 0;
    const Cycle boxed = planes_first ? beside(UnitKind::kBox, beside(UnitKind::kPlane, moved))
                                     : beside(UnitKind::kPlane, beside(UnitKind::kBox, moved));
    const Cycle known = std::max(moved, beside(UnitKind::kDecoder, at));
    Cycle met = known;
    for (const UnitKindRow& row : kUnitKinds)
      if (row.stage == Stage::kPrimitive) met = std::max(met, beside(row.kind, known));
    const Cycle looked_up = beside(UnitKind::kMicromap, met);
    const Cycle seen = inline_any_hit ? beside(UnitKind::kAnyHit, looked_up) : looked_up;
    // A hit finds its place in the buffer step by step, and the next one when it is there.
    const std::uint64_t steps = starts[UnitKind::kHitBuffer];
    if (steps == 0) return std::max(boxed, seen);
    UnitBank& buffers = units[UnitKind::kHitBuffer];
    const UnitBank::Reservation buffered = buffers.reserve_beside(seen, steps);
    const Cycle in_turn = seen + buffers.chain(steps);
    if (in_turn > buffered.last) overlap.expect(buffered.first - buffers.latency(), in_turn);
    return std::max({boxed, buffered.last, in_turn});
  }
};

}  // namespace carousel::ringbus::cycle
