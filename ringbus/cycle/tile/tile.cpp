#include "ringbus/cycle/tile/tile.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

Tile::Tile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings, Ports ports)
    : machine_(machine),
      memory_(memory),
      blocks_(settings.blocks),
      id_(id),
      trace_(id.value, settings.observed.steps),
      transforms_(settings.accuracy, machine.accel, machine.stores[id.value]->slots()),
      walk_(machine.accel, transforms_, settings.resource.collections.order),
      resource_(settings.resource, machine.accel, *machine.stores[id.value],
                {settings.statistics ? &sink_ : nullptr, &walk_, &transforms_, settings.blocks,
                 settings.resource.collections.when_full == WhenFull::kSpill, ports.questions != nullptr}),
      logic_(machine, resource_),
      ports_(std::move(ports)),
      tester_(settings.testers, settings.plane_order, settings.reads_per_cycle,
              settings.resource.bundles.builder.rays_per_cycle, settings.banks,
              settings.has_distributor ? &settings.link : nullptr),
      shapes_(settings.memory, settings.link, ports_),
      completed_port_(settings.link, ports_),
      travelling_(machine, id, settings.link),
      help_(settings.link, ports_),
      packet_size_(settings.resource.collections, settings.resource.packets, settings.link,
                   machine.stores.front()->layout()),
      places_(settings.cells, settings.banks),
      ids_per_cycle_(static_cast<Cycle>(settings.resource.packets.ids_per_cycle)),
      sort_rate_(static_cast<Cycle>(settings.resource.collections.sort_ids_per_cycle)),
      question_wire_(settings.link, control_latency(settings.link)),
      issue_places_(static_cast<std::size_t>(settings.memory.fetch_ahead) + 1),
      visit_all_(machine.topology.visits_all()),
      cuts_through_(!visit_all_ && !machine.topology.direct()),
      broadcasts_(machine.topology.broadcasts()),
      two_outputs_(settings.central),
      forwards_(settings.testers.distributor.stragglers == TestersConfig::Distributor::Stragglers::kForward),
      fetch_by_resource_(settings.memory.fetch != MemoryConfig::Fetch::kPacket),
      multicast_(settings.memory, id, machine.topology.resources()),
      contexts_fetch_(!machine.stays &&
                      (fetch_by_resource_ || settings.resource.collections.traversal == Traversal::kTreelet)),
      partial_(settings.resource.collections.partial),
      memory_latency_(static_cast<Cycle>(settings.memory.l2_latency_cycles + settings.memory.dram_latency_cycles)),
      starts_later_(fetch_by_resource_ || settings.resource.collections.traversal == Traversal::kTreelet),
      window_(static_cast<std::size_t>(settings.testers.window)),
      steps_always_(window_ > 1 || partial_ == Partial::kIdle),
      passed_over_(ports_.in.size()),
      contexts_(static_cast<std::size_t>(settings.testers.contexts)),
      phases_(contexts_.size()),
      visits_(memory, shapes_, tester_, contexts_.size(),
              static_cast<ShapeBuffer::User>(contexts_.size() + issue_places_)),
      fault_(settings.fault),
      in_test_(machine.stores[id.value]->slots(), contexts_.size() > 1 && settings.resource.bundles.size == 0),
      spill_memory_(id,
                    static_cast<std::uint64_t>(block_rays(settings.resource.collections, settings.resource.packets))),
      answers_due_(broadcasts_ ? machine.packets_per_direction : 0),
      trips_(machine.first_packet(id).value, machine.topology.directions() * machine.packets_per_direction),
      ledger_(tester_),
      recording_(settings.recording),
      samples_(settings.observed.samples, counter_index(PortCounter::kBusy, ports_.out.size(), kFirstPortCounter)) {
  record_parts();
  using Kind = FaultsConfig::Resource::Kind;
  pauses_ = fault_.kind == Kind::kPause && fault_.number == id.value;
  stops_ = fault_.kind == Kind::kStop && fault_.number == id.value;
  steps_always_ |= pauses_ || stops_;
}

// ---- time

Cycle Tile::next() const {
  return std::min({next_on_links(), next_on_side(), next_here_, next_start_, visits_.next()});
}

Cycle Tile::next_on_links() const {
  const Cycle arrival = next_arrival();
  return may_send_ ? std::min(arrival, next_credit()) : arrival;
}

// An arrival that is not later than the last step was dealt with in it, or waits for another event.
Cycle Tile::next_arrival() const {
  Cycle first = kNever;
  for (const InPort& in : ports_.in)
    if (const Cycle at = window_ > 1 ? in.next_after(now_) : in.next(); at > now_ && at < first) first = at;
  return first;
}

// A step takes in all that has arrived.
Cycle Tile::next_on_side() const {
  return std::min(shapes_.next(), next_but_shapes());
}

Cycle Tile::next_but_shapes() const {
  const Cycle first = std::min(ports_.new_rays->next(), help_.next_job());
  return ports_.answers == nullptr ? first : std::min(first, ports_.answers->next());
}

// The time at which a packet can leave, as far as that is known, or at which a credit comes that is waited for.
Cycle Tile::next_credit() const {
  Cycle first = kNever;
  for (const OutPort& out : ports_.out)
    if (const Cycle at = out.next(wants_credit_); at > now_ && at < first) first = at;
  return first;
}

bool Tile::wants_credit() const {
  return machine_.flow.bubble() && ((!issue_.empty() && is_ready(issue_.front())) || travelling_.waiting());
}

Cycle Tile::next_egress() const {
  Cycle first = phases_.first_end_after(now_, phases_.in(ContextPhase::kComputing));
  const auto consider = [&](Cycle at) {
    if (at > now_ && at < first) first = at;
  };
  consider(next_partial_);
  consider(help_.ends());
  consider(travelling_.next());
  if (dispatch_free_ > now_ && dispatch_free_ < first && dispatch_wanted()) first = dispatch_free_;
  return first;
}

bool Tile::dispatch_wanted() const {
  if (travelling_.waiting() || (!issue_.empty() && is_ready(issue_.front()))) return true;
  // Collections that are not full may go when the dispatch stage has nothing else to do.
  if (partial_ == Partial::kIdle && issue_.empty() && !resource_.idle()) return true;
  return std::any_of(ports_.in.begin(), ports_.in.end(),
                     [&](const InPort& in) { return in.next() <= now_ && stops_here(in); });
}

void Tile::run(Cycle end) {
  for (;;) {
    const Cycle links = next_on_links(), now = std::min({links, next_here_, next_start_, side_arrival_});
    visits_.forget_news();
    if (const Cycle event = visits_.run_before(std::min(now, end)); event != kNever) {
      if (visits_.has_news()) {
        step(event);
        continue;
      }
      if (samples_.due(event)) [[unlikely]]
        sample(event);
      note_blocked(event);
      note_state(event);
      continue;
    }
    if (now >= end) {
      next_ = std::min(now, visits_.next());
      return;
    }
    if (samples_.due(now)) [[unlikely]]
      sample(now);
    // Where a ray's test ends in this cycle, it comes first, as in every step.
    if (!steps_always_ && now < std::min(next_here_, visits_.next()) && (side_arrival_ > now || take_shapes(now)) &&
        (next_start_ > now || start_alone(now)) && (links > now || pass_on(now)))
      continue;
    step(now);
  }
}

// What happens at a time at which nothing ends or is due but what their names say. They do it as a step would, without
// a look at the other parts, and return false if there is more to do; then a step has to go on from there.

/// Takes in shapes for rays in subtrees.
bool Tile::take_shapes(Cycle now) {
  if (next_but_shapes() <= now) return false;
  note_blocked(now);
  const bool tested = visits_.testing();
  shapes_.take_answers(now);
  visits_.serve(now);
  if (visits_.has_news() || !shapes_.spill_answers().empty()) return false;
  side_arrival_ = next_on_side();
  if (tested != visits_.testing()) note_state(now);
  return true;
}

/// Begins tests of packets that dispatch has read.
bool Tile::start_alone(Cycle now) {
  note_blocked(now);
  start_tests(now);
  const ContextPhases::Set computing = phases_.in(ContextPhase::kComputing);
  const Cycle ends = phases_.first_end_after(0, computing);
  if (visits_.has_news() || ends <= now) return false;
  next_start_ = phases_.first_end_after(now, phases_.in(ContextPhase::kStarting));
  next_here_ = std::min(next_here_, ends);
  note_state(now);
  return true;
}

/// Lets packets pass by the resource and leave.
bool Tile::pass_on(Cycle now) {
  if (waits_for_place_) return false;
  note_blocked(now);
  for (OutPort& out : ports_.out) out.take_credits(now);
  do {
    cut_through(now);
    for (const InPort& in : ports_.in) {
      if (in.next() > now || !stops_here(in)) continue;
      if (dispatch_free_ <= now) return false;
      next_here_ = std::min(next_here_, dispatch_free_);
    }
  } while (send(now));
  now_ = now;
  look_at_links();
  if (blocked_from_ != kNever || ledger_.state() == TileState::kLink) note_state(now);  // else it has not changed
  return true;
}

/// Notes what the links wait for.
void Tile::look_at_links() {
  may_send_ = awaits_credit_ = wants_credit_;
  blocked_from_ = kNever;
  for (const OutPort& out : ports_.out) {
    may_send_ |= !out.empty();
    awaits_credit_ |= out.awaits_credit();
    blocked_from_ = std::min(blocked_from_, out.blocked_from());
  }
}

/// The state at the end of an event. It stays until the next one, unless a link becomes blocked before.
void Tile::note_state(Cycle now) {
  const TileState state = classify(blocked_from_ <= now);
  ledger_.enter(state, now);
  if (state == TileState::kLink || blocked_from_ == kNever || classify(true) != TileState::kLink) blocked_from_ = kNever;
}

/// Before anything changes at `now`.
void Tile::note_blocked(Cycle now) {
  if (blocked_from_ < now) ledger_.enter(TileState::kLink, blocked_from_);
}

void Tile::step(Cycle now) {
  sample(now);
  note_blocked(now);
  now_ = now;
  census_.until(now, resource_.collections().memberships());
  for (OutPort& out : ports_.out) out.take_credits(now);
  resource_.ripen(now);
  if (stops_ && fault_is_due()) stop(now);
  const bool side = side_arrival_ <= now;
  if (side) {
    shapes_.take_answers(now);
    take_spilled();
  }
  serve(now);
  if (starts_later_) start_tests(now);
  if (side) {
    take_opacities(now);
    take_new_rays(now);
  }
  served_ = true;
  for (bool again = true; again;) {
    again = finish_tests(now);
    again |= help_.step(now, testers_free());
    again |= cut_through(now);
    again |= handle(now);
    again |= admit();
    // The issue queue takes no more than before if only packets have been sent since.
    if (again || served_ || !logic_.admission.empty()) again |= fill_issue(now);
    served_ = false;
    again |= send(now);
  }
  hand_over(now);
  if (side) side_arrival_ = next_on_side();
  if (logic_.draining() && !told_drained_ && drained()) {
    told_drained_ = true;
    completed_port_.notify(CompletedRays::Note::kDrained, now);
  }
  if (pauses_ && fault_is_due()) {
    // Dispatch takes nothing up; packets in test are finished.
    dispatch_free_ = std::max(dispatch_free_, now) + static_cast<Cycle>(fault_.cycles);
    pauses_ = false;
  }
  help_.notify(now, testers_free() && (issue_.empty() || is_ready(issue_.front())));
  if (partial_ == Partial::kAfter && issue_.size() < issue_places_)
    next_partial_ = std::min(next_partial_, resource_.next_ripe().value_or(kNever));
  next_start_ = phases_.first_end_after(now, phases_.in(ContextPhase::kStarting));
  next_here_ = next_egress();
  wants_credit_ = wants_credit();
  look_at_links();
  note_state(now);
}

TileState Tile::classify(bool blocked) const {
  if (help_.shading()) return TileState::kShading;
  using enum ContextPhase;
  const bool walking = phases_.in(kWalking) != 0;
  if ((phases_.in(kComputing) | phases_.in(kStarting)) != 0 || (walking && visits_.testing()))
    return TileState::kTesting;
  if (walking || phases_.in(kFetching) != 0) return TileState::kMemory;
  if (blocked) return TileState::kLink;
  if (!issue_.empty()) return is_ready(issue_.front()) ? TileState::kLink : TileState::kMemory;
  if (storage_full_) return TileState::kStorage;
  if (!resource_.idle() && resource_.packets_in_flight() > 0 && logic_.free.none()) return TileState::kCredits;
  return TileState::kIdle;
}

// ---- arrivals beside the ring

bool Tile::admit() {
  const bool loaded = travelling_.admit(now_, logic_.admission);
  if (logic_.admission.empty()) return loaded;
  const bool moved = logic_.admission.admit(resource_, [this](std::span<const RayId> rays) {
    trace_.note(now_, StepKind::kNewRays, 0, rays.size());
    if (recording_.ray != nullptr) [[unlikely]]
      note_admitted(rays);
  });
  write_spilled(now_);
  storage_full_ = logic_.admission.short_of_room();
  return moved;
}

// ---- departures

bool Tile::send(Cycle now) {
  bool moved = false;
  for (OutPort& out : ports_.out) moved |= out.send(now);
  return moved;
}

// ---- the end, good or bad

std::uint64_t Tile::hops() const {
  std::uint64_t hops = 0;
  for (const OutPort& out : ports_.out) hops += out.packets();
  return hops;
}

ResourceStatistics Tile::statistics() const {
  ResourceStatistics s = sink_.statistics();
  s.hops = hops();
  s.visits += passed_;
  s.bubbles += passed_;
  s.seen_rays += passed_rays_;
  return s;
}

TileResult Tile::result() const {
  TileResult t;
  ledger_.fill_in(t);
  t.dispatch.busy = dispatch_busy_;
  t.sent = sent_;
  t.shapes = shapes_.counts();
  t.spilled = spill_memory_.moved();
  t.transformed_rays = transforms_.bytes();
  t.round_trips = trips_.latency();
  t.collection_ages = resource_.collections().ages();
  t.packet_cycles = trips_.packet_cycles();
  return t;
}

ResourceAgent::Busy Tile::busy() const {
  return {tester_.busy_units(), tester_.busy_reads(), dispatch_busy_};
}

bool Tile::at_rest() const {
  return logic_.at_rest() && travelling_.at_rest() && rays_out_ == 0 && issue_.empty() &&
         std::all_of(ports_.out.begin(), ports_.out.end(), [](const OutPort& out) { return out.empty(); });
}

std::string Tile::describe() const {
  if (at_rest()) return "";
  std::string text = logic_.describe() + fmt::format(", {} to be issued", issue_.size());
  if (!travelling_.at_rest()) text += ", new rays wait for packets or records";
  if (rays_out_ > 0) text += fmt::format(", {} packets of new rays out", rays_out_);
  for (std::size_t port = 0; port < ports_.out.size(); ++port)
    if (const std::string packet = blocked(port); !packet.empty())
      text += fmt::format("; {} cannot leave, {} more behind it", packet, ports_.out[port].egress() - 1);
  return text;
}

std::string Tile::blocked(std::size_t port) const {
  return ports_.out[port].awaits_credit() ? logic_.describe(ports_.out[port].front()) : "";
}

}  // namespace carousel::ringbus::cycle
