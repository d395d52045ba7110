#include "ringbus/cycle/testers/distributor.h"

#include <algorithm>

#include "ringbus/cycle/testers/unit_passes.h"

namespace carousel::ringbus::cycle {

namespace {

/// The share of ray `i` in the passes of some rays.
std::uint64_t share(std::uint64_t passes, std::size_t rays, std::size_t i) {
  return passes / rays + (i < passes % rays ? 1 : 0);
}

/// As share(), of the passes through units of a kind. A program is run by one tester from its beginning to its end, and
/// takes the mean time of all in the packet.
std::uint64_t share_of_passes(UnitKind kind, const IntersectionCounts& counts, std::size_t rays, std::size_t i) {
  if (kind != UnitKind::kProcedural || counts.programs == 0) return share(passes_of(kind, counts), rays, i);
  const auto cycles_before = [&](std::size_t ray) {
    const std::uint64_t programs = counts.programs / rays * ray + std::min<std::uint64_t>(ray, counts.programs % rays);
    return counts.program_cycles * programs / counts.programs;
  };
  return share(counts.procedural - counts.programs, rays, i) + cycles_before(i + 1) - cycles_before(i);
}

}  // namespace

Distributor::Distributor(const TestersConfig& testers, const RayStages& stages, const LinkConfig& link)
    : stages_(stages),
      ids_per_cycle_(static_cast<std::uint64_t>(testers.distributor.ids_per_cycle)),
      results_per_cycle_(static_cast<std::uint64_t>(testers.distributor.results_per_cycle)),
      bytes_per_cycle_(static_cast<std::uint64_t>(link.bytes_per_cycle)),
      latency_(static_cast<Cycle>(link.latency_cycles)),
      window_(testers.distributor.out_of_order + 1) {
  OneTester one{{}, Places(testers.distributor.queue), Places(testers.distributor.results)};
  for (const auto [kind, bank] : one.units) bank = UnitBank(testers.units[kind]);
  testers_.assign(static_cast<std::size_t>(testers.distributor.testers), one);
}

/// The cycle in which the next ID leaves the distributor. `in_cycle`: IDs that have left in next_hand_out_.
Cycle Distributor::hand_out(OneTester& to, std::uint64_t& in_cycle) {
  if (in_cycle == ids_per_cycle_) ++next_hand_out_, in_cycle = 0;
  if (const Cycle place = to.queue.free_at(); place > next_hand_out_) {
    counts_.queue_full += place - next_hand_out_;
    next_hand_out_ = place;
    in_cycle = 0;
  }
  if (in_cycle++ == 0) ++counts_.handing_out;
  return next_hand_out_;
}

/// The first cycle from `at` on in which the decision point takes one result more.
Cycle Distributor::decide(Cycle at) {
  std::size_t i = at - decisions_begin_;
  for (;; ++i) {
    if (i >= decisions_.size()) decisions_.resize(i + 1);
    if (decisions_[i] < results_per_cycle_) break;
  }
  ++decisions_[i];
  return decisions_begin_ + i;
}

void Distributor::test(Cycle at, std::span<const std::uint32_t> slots, const IntersectionCounts& counts,
                       std::uint64_t shape_bytes, BankOverlap& overlap, std::vector<Cycle>& decided) {
  for (; decisions_begin_ < at && !decisions_.empty(); ++decisions_begin_) decisions_.pop_front();
  decisions_begin_ = std::max(decisions_begin_, at);
  ++counts_.packets;
  counts_.ids += slots.size();
  counts_.shape_bytes += shape_bytes;
  bus_free_ = std::max(at, bus_free_) + ceil_div(shape_bytes, bytes_per_cycle_);
  const Cycle shapes_there = bus_free_ + latency_, allowed = window_.free_at();
  const Cycle older_done = older_done_;
  next_hand_out_ = std::max(at, next_hand_out_);
  std::uint64_t in_cycle = 0;
  decided.clear();
  for (std::size_t i = 0; i < slots.size(); ++i) {
    OneTester& tester = testers_[slots[i] % testers_.size()];
    const Cycle read = hand_out(tester, in_cycle) + latency_ + 1;
    const Cycle ready = std::max({read, shapes_there, tester.free_at});
    const Cycle in_turn = std::max(ready, allowed), start = std::max(in_turn, tester.results.free_at());
    if (i == 0 && start >= shapes_there) counts_.shapes_taken += shape_bytes;
    counts_.held_back += in_turn - ready;
    counts_.results_full += start - in_turn;
    counts_.ahead += start < older_done ? 1 : 0;
    tester.queue.take(start + latency_);

    PerUnit<std::uint64_t> starts{};
    for (const UnitKindRow& row : kUnitKinds) starts[row.kind] = share_of_passes(row.kind, counts, slots.size(), i);
    Cycle from = start;
    if (const std::uint64_t inversion = i == 0 ? inversion_passes(counts) : 0; inversion > 0)
      from = tester.units[UnitKind::kTransform].reserve(start, inversion).last;
    const Cycle answer = stages_.through(tester.units, from, starts, overlap);
    tester.free_at = std::max(start + 1, from);
    for (const auto [kind, bank] : tester.units) tester.free_at = std::max(tester.free_at, bank.free_at());
    counts_.tester_busy += tester.free_at - start;

    tester.last_result = std::max(tester.last_result, answer);
    const Cycle there = tester.last_result + latency_;
    tester.last_decided = decide(std::max(there, tester.last_decided));
    counts_.undecided += tester.last_decided - there;
    tester.results.take(tester.last_decided + latency_);
    decided.push_back(tester.last_decided + 1);
    older_done_ = std::max(older_done_, tester.last_decided + 1);
  }
  ++next_hand_out_;
  window_.take(older_done_ + latency_);
}

void Distributor::record(SliceLog& slices, std::uint32_t track) {
  for (OneTester& tester : testers_)
    for (const auto [kind, bank] : tester.units) bank.record(slices, track++);
}

void Distributor::close(Cycle end) {
  for (OneTester& tester : testers_)
    for (const auto [kind, bank] : tester.units) bank.close(end);
}

Cycle Distributor::Units::busy() const {
  Cycle sum = 0;
  for (const OneTester& tester : of_.testers_) sum += tester.units[kind_].busy();
  return sum / of_.testers_.size();
}

double Distributor::Units::fill() const {
  Cycle worked = 0, held = 0;
  for (const OneTester& tester : of_.testers_) {
    worked += tester.units[kind_].worked();
    held += tester.units[kind_].busy() * tester.units[kind_].units();
  }
  return held == 0 ? 0 : static_cast<double>(worked) / static_cast<double>(held);
}

Cycle Distributor::Units::busy_before(Cycle now) const {
  Cycle sum = 0;
  for (OneTester& tester : of_.testers_) sum += tester.units[kind_].busy_before(now);
  return sum / of_.testers_.size();
}

}  // namespace carousel::ringbus::cycle
