#include "ringbus/cycle/tile/tile.h"

#include <algorithm>
#include <stdexcept>

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

// ---- a step

/// Does once what can be done. Returns whether that may have made something else possible.
[[gnu::always_inline]] inline bool Tile::go_on(Cycle now) {
  bool again = finish_tests(now);
  again |= help_.step(now, testers_free());
  // Packets that pass by make room for nothing else here; but dispatch may be idle then.
  again |= cut_through(now) && partial_ == Partial::kIdle;
  again |= handle(now);
  again |= admit();
  // The issue queue takes no more than before if only packets have been sent since.
  if (again || served_ || !logic_.admission.empty()) again |= fill_issue(now);
  served_ = false;
  again |= send(now);
  return again;
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
  while (go_on(now)) {
  }
  if (kChecked && now % 4 == 0) {
    served_ = true;  // so that it looks everywhere
    if (go_on(now)) throw std::logic_error("a step has ended before all was done");
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

/// Returns whether there is a place again in an egress queue that was full.
bool Tile::send(Cycle now) {
  bool room = false;
  for (OutPort& out : ports_.out) {
    const bool full = !out.has_place();
    room |= out.send(now) && full;
  }
  return room;
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
