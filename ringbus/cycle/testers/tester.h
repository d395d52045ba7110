#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "accel/box/bundle_intersect.h"
#include "core/config/fields/cull_planes.h"
#include "core/config/fields/testers.h"
#include "core/config/fields/topology.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/ids.h"
#include "ringbus/cycle/testers/bank_overlap.h"
#include "ringbus/cycle/testers/distributor.h"
#include "ringbus/cycle/testers/lanes.h"
#include "ringbus/cycle/testers/level_cycles.h"
#include "ringbus/cycle/testers/ray_places.h"
#include "ringbus/cycle/testers/ray_stages.h"
#include "ringbus/cycle/testers/unit_bank.h"
#include "ringbus/cycle/testers/unit_passes.h"
#include "ringbus/resource/visit/test_outcome.h"
#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus::cycle {

/// The test units of a resource, a bank for each kind, and the port of its ray store. The stages of a visit
/// (core/types/ unit_kind.h) are pipelined: a ray's boxes are tested when it has been transformed, while the next ray
/// is, and its planes when its boxes have been; or, by `cull_planes.order`, its planes first and then the boxes that
/// are left. A matrix that is inverted first takes its passes through the transform units ahead of the rays. Records of
/// rays and bundles come from the store one after another if its port is narrow, and rays that leave a bundle are
/// tested after it. A unit of several lanes starts a vector of tests at a time (lanes.h). Primitives of all kinds are
/// tested beside each other and beside boxes, where a node holds both.
class Tester {
 public:
  using Order = CullPlanesConfig::Order;
  /// `reads_per_cycle`: as rays.reads_per_cycle; 0: reads take no time. `regrouped_per_cycle`: rays that the builder of
  /// bundles takes. `banks_of_rays`: as rays.banks; 0: the store has one port. `to_distributor`: its links with the
  /// testers; null: there is none.
  explicit Tester(const TestersConfig& config, Order order = Order::kBoxFirst, std::int64_t reads_per_cycle = 0,
                  std::int64_t regrouped_per_cycle = 1, std::int64_t banks_of_rays = 0,
                  const LinkConfig* to_distributor = nullptr)
      : store_({std::max<std::int64_t>(1, reads_per_cycle), 1, 1}),
        builder_({regrouped_per_cycle, 1, 1}),
        lanes_(config.simd),
        blocks_(config.bundle_blocks),
        overlap_(static_cast<Cycle>(lanes_.reformatting())),
        stages_{order, config.any_hit == TestersConfig::AnyHit::kInline},
        reads_cost_(reads_per_cycle > 0),
        banks_of_rays_(static_cast<std::uint64_t>(banks_of_rays)) {
    for (const auto [kind, bank] : banks_) bank = UnitBank(config.units[kind]);
    if (to_distributor != nullptr) distributor_.emplace(config, stages_, *to_distributor);
  }

  /// The time of the last answer to the tests of one strip, started at `at`, for `reads` records, and for the passes
  /// of bundles; rays that leave bundles are then put into new ones.
  Cycle strip(Cycle at, const IntersectionCounts& counts, std::uint64_t reads = 0, const BundlePasses& bundles = {},
              const RayPlaces& places = {}) {
    const TestedRays of{reads, places.cell};
    const UnitBank::Reservation read = banks_of_rays_ > 0 ? banked_reads(at, counts, reads, places.bank)
                                                          : store_.reserve(at, reads_cost_ ? reads : 0),
                                bundled = bundle_tests(read, bundles);
    const Cycle inverse = inverted(bundled.first, counts);
    const UnitBank::Reservation moved = tested(banks_[UnitKind::kTransform], {inverse, std::max(inverse, bundled.last)},
                                               starts(UnitKind::kTransform, counts, of));
    const Cycle decoded = decode(bundled.first, counts.decoded);
    const UnitBank::Reservation known{std::max(moved.first, decoded), std::max(moved.last, decoded)};
    const Cycle end = std::max(boxes(moved, counts, of), primitives(known, counts, of)) + lanes_.reformatting();
    return bundles.regrouped == 0 ? end : builder_.reserve(end, bundles.regrouped).last;
  }

  /// Tests a packet's rays behind a distributor, as Distributor::test() says.
  void distribute(Cycle at, std::span<const std::uint32_t> slots, const IntersectionCounts& counts,
                  std::uint64_t shape_bytes, std::vector<Cycle>& decided) {
    for (const UnitKindRow& row : kUnitKinds)
      count(row.kind, row.stage == Stage::kAnyHit ? lookups(counts) : passes_of(row.kind, counts));
    count(UnitKind::kTransform, inversion_passes(counts));
    distributor_->test(at, slots, counts, shape_bytes, overlap_, decided);
  }
  Distributor* distributor() { return distributor_ ? &*distributor_ : nullptr; }
  const Distributor* distributor() const { return distributor_ ? &*distributor_ : nullptr; }

  /// The time of the last answer to the tests of a single ray, beside others.
  Cycle ray(Cycle at, const RayTests& ray) {
    if (ray.inversion > 0) at = invert(at, ray.inversion);
    PerUnit<std::uint64_t> vectors{};
    for (const UnitKindRow& row : kUnitKinds)
      if (const std::uint64_t passes = ray.passes(row.kind);
          passes > 0 && (row.stage != Stage::kAnyHit || stages_.inline_any_hit))
        vectors[row.kind] = starts(row.kind, passes, {1});
    // Neither the decoding of a block nor the steps of a ray's buffer are spread over lanes.
    for (const UnitKind kind : {UnitKind::kDecoder, UnitKind::kHitBuffer}) vectors[kind] = ray.tests[kind];
    return stages_.through(banks_, at, vectors, overlap_);
  }
  Cycle ray(Cycle at, const IntersectionCounts& counts) { return ray(at, ray_tests(counts)); }
  /// As above, for passes of one kind alone, which is none of those that RayStages treats apart: decoders, any-hit
  /// units and hit buffers.
  Cycle ray(Cycle at, UnitKind kind, std::uint64_t passes) {
    return banks_[kind].reserve_beside(at, starts(kind, passes, {1})).last;
  }
  /// The end of the inversion of a matrix, which takes so many passes.
  Cycle invert(Cycle at, std::uint64_t passes) {
    count(UnitKind::kTransform, passes);
    return banks_[UnitKind::kTransform].reserve(at, passes).last;
  }
  /// The time at which so many compressed blocks have been decoded. The units take them whole, not in lanes,
  /// and blocks of several visits side by side.
  Cycle decode(Cycle at, std::uint64_t blocks) {
    count(UnitKind::kDecoder, blocks);
    return blocks == 0 ? at : banks_[UnitKind::kDecoder].reserve_beside(at, blocks).last;
  }
  /// The time at which `records` records that are wanted at `at` have been read, beside others.
  Cycle read(Cycle at, std::uint64_t records) { return reads_cost_ ? store_.reserve_beside(at, records).last : at; }

  /// Adds the cycles in which each bank was busy, from the last call until `now`, to those in `state`, the resource's
  /// state in all of these cycles.
  void account(TileState state, Cycle now) {
    advance(now);
    const TestingCycles together = overlap_.take();
    if (state == TileState::kTesting) {
      testing_.any += together.any;
      testing_.latency += together.latency;
    }
    builder_.busy_before(now);
    for_each_used([&](UnitKind kind) {
      distributor_ ? units_[kind].account(distributor_->units(kind), state, now)
                   : units_[kind].account(banks_[kind], state, now);
    });
    ray_reads_.account(store_, state, now);
    primitive_reads_.account(primitive_store_, state, now);
  }
  /// Fills in how long each bank was busy until the last account().
  void fill_in(TileResult& result) {
    result.testing = testing_;
    for (const auto [kind, ledger] : units_) {
      result.units[kind] = ledger.use;
      const UnitBank& bank = banks_[kind];
      result.units[kind].fill = distributor_ ? distributor_->units(kind).fill() : fill_of(bank);
      result.units[kind].passes = passes_[kind];
      result.units[kind].lanes = banks_[kind].tests() * (kind == UnitKind::kDecoder ? 1 : lanes_.count());
    }
    result.ray_reads = ray_reads_.use;
    result.primitive_ray_reads = primitive_reads_.use;
    result.second_reads = second_reads_;
    result.bank_conflicts = conflicts_;
    if (distributor_) result.distributor = distributor_->counts();
  }

  /// Its busy cycles alone.
  PerUnit<Cycle> busy_units() const {
    PerUnit<Cycle> busy{};
    for (const auto [kind, ledger] : units_) busy[kind] = ledger.use.busy;
    return busy;
  }
  /// Cycles in which the ray store is read: the sum of both ports where there are banks.
  Cycle busy_reads() const { return ray_reads_.use.busy + primitive_reads_.use.busy; }

  /// Records that both ports have read for one test, so far.
  std::uint64_t second_reads() const { return second_reads_; }

  /// The cycles before `at` in which each bank was busy. Times of calls, also of account(), must not decrease.
  PerUnit<Cycle> busy_before(Cycle at) {
    advance(at);
    PerUnit<Cycle> busy{};
    for (const auto [kind, bank] : banks_)
      busy[kind] = distributor_ ? distributor_->units(kind).busy_before(at) : bank.busy_before(at);
    return busy;
  }
  Cycle reads_before(Cycle at) { return advance(at), store_.busy_before(at); }
  Cycle primitive_reads_before(Cycle at) { return advance(at), primitive_store_.busy_before(at); }

  /// Tracks from `track` on: one a kind of unit, of each tester behind a distributor, and one each of the ray store's
  /// ports.
  void record(SliceLog& slices, std::uint32_t track) {
    if (distributor_) {
      distributor_->record(slices, track);
      return;  // its testers read records without ports that could be busy
    }
    for (const auto [kind, bank] : banks_) bank.record(slices, track + static_cast<std::uint32_t>(unit_index(kind)));
    store_.record(slices, track + static_cast<std::uint32_t>(kUnitKinds.size()));
    primitive_store_.record(slices, track + static_cast<std::uint32_t>(kUnitKinds.size()) + 1);
  }
  void close(Cycle end) {
    advance(end);
    if (distributor_) distributor_->close(end);
    for (const auto [kind, bank] : banks_) bank.close(end);
    store_.close(end);
    primitive_store_.close(end);
  }

  const UnitBank& bank(UnitKind kind) const { return banks_[kind]; }
  const UnitBank& store() const { return store_; }  ///< the port of the ray store, or of its banks to the box units

 private:
  struct Ledger {
    BankUse use;

    template <class Bank>
    void account(Bank&& bank, TileState state, Cycle now) {
      if (use.busy == bank.busy()) return;  // it has been idle since
      const Cycle busy = bank.busy_before(now);
      use.busy_in[static_cast<std::size_t>(state)] += busy - use.busy;
      use.busy = busy;
    }
  };

  void count(UnitKind kind, std::uint64_t passes) {
    passes_[kind] += passes;
    used_ |= std::uint32_t{passes > 0} << unit_index(kind);
  }
  /// Most machines use few kinds of units.
  template <class Call>
  void for_each_used(const Call& call) {
    for (std::uint32_t rest = used_; rest != 0; rest &= rest - 1)
      call(kUnitKinds[static_cast<std::size_t>(std::countr_zero(rest))].kind);
  }
  /// Before any bank forgets times until `now`.
  void advance(Cycle now) {
    overlap_.advance(now, [&](const auto& take) {
      if (distributor_) distributor_->each_bank(take);
      for_each_used([&](UnitKind kind) { take(std::as_const(banks_[kind])); });
      for (const UnitBank* port : {&store_, &primitive_store_, &builder_}) take(*port);
    });
  }
  static double fill_of(const UnitBank& bank) {
    return bank.busy() == 0 ? 0 : static_cast<double>(bank.worked()) / static_cast<double>(bank.busy() * bank.units());
  }
  /// The vectors of lanes in which the passes of some rays are started.
  std::uint64_t starts(UnitKind kind, std::uint64_t passes, const TestedRays& of) {
    count(kind, passes);
    return lanes_.starts(passes, of);
  }
  std::uint64_t starts(UnitKind kind, const IntersectionCounts& counts, const TestedRays& of) {
    return starts(kind, passes_of(kind, counts), of);
  }
  /// The records of a packet through the ports of the banks, `most` of them from one bank: through the one port for
  /// boxes, through the other for primitives, and through both where a node holds both.
  UnitBank::Reservation banked_reads(Cycle at, const IntersectionCounts& counts, std::uint64_t reads,
                                     std::uint64_t most) {
    const bool primitives = std::any_of(kUnitKinds.begin(), kUnitKinds.end(), [&](const UnitKindRow& row) {
      return row.stage == Stage::kPrimitive && counts.*row.tests > 0;
    });
    const bool boxes = counts.box > 0 || !primitives;
    UnitBank::Reservation read{at, at};
    const auto through = [&](UnitBank& port) {
      const UnitBank::Reservation own = port.reserve(at, most);
      read = {std::max(read.first, own.first), std::max(read.last, own.last)};
      conflicts_ += most - ceil_div(reads, banks_of_rays_);
    };
    if (boxes) through(store_);
    if (primitives) through(primitive_store_);
    if (boxes && primitives) second_reads_ += reads;
    return read;
  }
  /// Tests for rays that come one after another from the bank before: the last of them is tested last.
  static UnitBank::Reservation tested(UnitBank& bank, const UnitBank::Reservation& before, std::uint64_t tests) {
    if (tests == 0) return before;
    const UnitBank::Reservation own = bank.reserve(before.first, tests);
    return {own.first, before.last > before.first ? std::max(own.last, before.last + bank.latency()) : own.last};
  }
  /// Tests that wait for the answers to the first begin with the first of these, divisions for directions come ahead of
  /// the first, and those for distances behind the last.
  UnitBank::Reservation bundle_tests(const UnitBank::Reservation& read, const BundlePasses& passes) {
    using Blocks = TestersConfig::BundleBlocks;
    const UnitKind kind = blocks_ == Blocks::kShared ? UnitKind::kBox : UnitKind::kBundle;
    const std::uint64_t first = blocks_ == Blocks::kPairs ? passes.at_once : passes.first;
    count(kind, first + passes.second);
    count(UnitKind::kReciprocal, std::uint64_t{passes.divided_before} + passes.divided_after);
    UnitBank& divider = banks_[UnitKind::kReciprocal];
    UnitBank::Reservation divided = tested(divider, read, passes.divided_before);
    if (passes.divided_before > 0) {  // a bundle's first test needs all of its directions
      const auto others = static_cast<Cycle>(ceil_div(Cycle{accel::kDirectionDivisions}, divider.units()) - 1);
      divided.first = std::min(divided.last, divided.first + others * divider.interval());
    }
    return tested(divider, tested(banks_[kind], tested(banks_[kind], divided, first), passes.second),
                  passes.divided_after);
  }
  Cycle boxes(const UnitBank::Reservation& moved, const IntersectionCounts& counts, const TestedRays& of) {
    UnitBank &box = banks_[UnitKind::kBox], &plane = banks_[UnitKind::kPlane];
    const std::uint64_t box_starts = starts(UnitKind::kBox, counts, of),
                        plane_starts = starts(UnitKind::kPlane, counts, of);
    if (stages_.order == Order::kBoxFirst || counts.plane == 0)
      return tested(plane, tested(box, moved, box_starts), plane_starts).last;
    return tested(box, tested(plane, moved, plane_starts), box_starts).last;
  }
  Cycle primitives(const UnitBank::Reservation& moved, const IntersectionCounts& counts, const TestedRays& of) {
    UnitBank::Reservation met = moved;
    for (const UnitKindRow& row : kUnitKinds) {
      if (row.stage != Stage::kPrimitive || counts.*row.tests == 0) continue;
      UnitBank::Reservation own = tested(banks_[row.kind], moved, starts(row.kind, counts, of));
      last_not_before(moved.last + program_time(row.kind, counts), banks_[row.kind], own);
      met = {std::max(met.first, own.first), std::max(met.last, own.last)};
    }
    const UnitBank::Reservation known =
        tested(banks_[UnitKind::kMicromap], met, starts(UnitKind::kMicromap, counts, of));
    const UnitBank::Reservation seen =
        tested(banks_[UnitKind::kAnyHit], known, starts(UnitKind::kAnyHit, lookups(counts), of));
    UnitBank& buffers = banks_[UnitKind::kHitBuffer];
    // Steps of a ray go one after another. The mean is taken for the ray that comes first.
    const Cycle in_turn =
        seen.first + buffers.chain(ceil_div(counts.buffer_steps, std::max<std::uint64_t>(1, of.rays)));
    UnitBank::Reservation buffered = tested(buffers, seen, starts(UnitKind::kHitBuffer, counts, of));
    last_not_before(in_turn, buffers, buffered);
    return buffered.last;
  }
  /// Answers of the bank that come one after another end no earlier than `until`.
  void last_not_before(Cycle until, const UnitBank& bank, UnitBank::Reservation& own) {
    if (until <= own.last) return;
    overlap_.expect(own.first - bank.latency(), until);
    own.last = until;
  }
  /// The least time until the answer to a program of the last ray that comes: the mean of the programs is taken for it.
  Cycle program_time(UnitKind kind, const IntersectionCounts& counts) const {
    if (kind != UnitKind::kProcedural || counts.programs == 0) return 0;
    return banks_[kind].chain(ceil_div(counts.program_cycles, counts.programs));
  }
  /// Any-hit calls that units of the resource answer.
  std::uint64_t lookups(const IntersectionCounts& counts) const {
    return stages_.inline_any_hit ? counts.any_hit_calls : 0;
  }
  Cycle inverted(Cycle at, const IntersectionCounts& counts) { return invert(at, inversion_passes(counts)); }

  PerUnit<UnitBank> banks_;
  PerUnit<std::uint64_t> passes_{};
  std::uint32_t used_ = 0;  // a bit for each kind that has had a pass
  UnitBank store_, primitive_store_{{1, 1, 1}}, builder_;
  Lanes lanes_;
  TestersConfig::BundleBlocks blocks_;
  BankOverlap overlap_;
  TestingCycles testing_;
  PerUnit<Ledger> units_;
  Ledger ray_reads_, primitive_reads_;
  RayStages stages_;
  std::optional<Distributor> distributor_;
  bool reads_cost_;
  std::uint64_t banks_of_rays_, conflicts_ = 0, second_reads_ = 0;  // see TileResult
};

}  // namespace carousel::ringbus::cycle
