#include "ringbus/cycle/tile/tile.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "ringbus/cycle/tile/resource_energy.h"

namespace carousel::ringbus::cycle {

namespace {

ShapeBuffer::User first_ray_user(const TileSettings& settings) {
  return static_cast<ShapeBuffer::User>(static_cast<std::size_t>(settings.testers.contexts) +
                                        IssueQueue::places(settings));
}

}  // namespace

Tile::Tile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings, Ports ports)
    : machine_(machine),
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
      needs_(
          {settings.resource.collections, settings.resource.packets, settings.link, machine.stores.front()->layout()},
          memory, settings.blocks, resource_, settings.central, machine.topology.broadcasts()),
      recorder_(id, machine, settings.recording, settings.observed.steps),
      dispatch_(settings.resource.packets.ids_per_cycle, recorder_),
      egress_(machine, id, logic_, needs_, ports_.out),
      room_(id, static_cast<std::uint64_t>(block_rays(settings.resource.collections, settings.resource.packets)),
            resource_, shapes_),
      travelling_(machine, id, settings.link, settings.recording.times),
      completions_(
          id, *machine.stores[id.value],
          (settings.testers.contexts > 1 || ports_.questions != nullptr) && settings.resource.bundles.size == 0,
          settings.link, ports_, travelling_, sink_, recorder_),
      retirement_(machine, resource_, logic_, needs_, settings.resource.collections.sort_ids_per_cycle, dispatch_,
                  room_, recorder_),
      any_hit_(settings.link, ports_),
      help_(settings.link, ports_),
      contexts_({machine, resource_, logic_, tester_, shapes_, walk_, needs_, recorder_, dispatch_, egress_,
                 completions_, retirement_, any_hit_},
                settings, first_ray_user(settings)),
      issue_(contexts_.parts(), settings, contexts_, help_, room_),
      entry_(machine, resource_, logic_, *ports_.new_rays, travelling_, dispatch_, egress_, room_, recorder_),
      dispatcher_(contexts_.parts(), settings, ports_.in, contexts_, issue_, entry_, help_),
      fault_(settings.fault, id, machine.stores[id.value]->slots() > 0),
      samples_(resource_.collections(), settings.observed.samples,
               counter_index(PortCounter::kBusy, ports_.out.size(), kFirstPortCounter)),
      ledger_(tester_),
      steps_always_(dispatcher_.has_window() || issue_.waits_for_idle() || fault_.is_ahead()) {
  recorder_.record_units(tester_, settings.recording.contexts);
}

// ---- a step

/// Does once what can be done. Returns whether that may have made something else possible.
[[gnu::always_inline]] inline bool Tile::keep_running(Cycle now) {
  bool again = finish_tests(now);
  again |= help_.step(now, contexts_.all_free());
  // Packets that pass by make room for nothing else here; but dispatch may be idle then.
  again |= dispatcher_.cut_through(now) && issue_.waits_for_idle();
  again |= dispatcher_.handle(now);
  again |= entry_.admit(now);
  // The issue queue takes no more than before if only packets have been sent since.
  if (again || served_ || !logic_.admission.empty()) again |= fill_issue(now);
  served_ = false;
  again |= egress_.send(now);
  return again;
}

void Tile::step(Cycle now) {
  begin_step(now);
  served_ = true;
  while (keep_running(now)) {
  }
  if (kChecked && now % 4 == 0) {
    served_ = true;  // so that it looks everywhere
    if (keep_running(now)) throw std::logic_error("a step has ended before all was done");
  }
  end_step(now);
}

/// Takes in what has come, but for packets.
void Tile::begin_step(Cycle now) {
  sample(now);
  note_blocked(now);
  now_ = now;
  samples_.count_ids(now);
  egress_.take_credits(now);
  resource_.ripen(now);
  if (fault_.stops(sink_.statistics())) stop(now);
  const bool side = due_.side <= now;
  if (side) {
    shapes_.take_answers(now);
    issue_.take_spilled();
  }
  served_ |= contexts_.serve(now);
  if (contexts_.starts_later()) contexts_.start(now);
  if (side) {
    contexts_.take_any_hit(now);
    entry_.take(now, [&](NewRays::Order order) { on_order(order, now); });
  }
}

/// Sends what goes beside the links, and looks for the next event.
void Tile::end_step(Cycle now) {
  completions_.hand_over(now);
  if (due_.side <= now) due_.side = next_on_side();
  if (logic_.draining() && drained() && fault_.tells_drained())
    completions_.port().notify(CompletedRays::Note::kDrained, now);
  // Dispatch takes nothing up then; packets in test are finished.
  if (const Cycle pause = fault_.pauses(sink_.statistics()); pause > 0) dispatch_.pause(now, pause);
  if (help_.on()) help_.notify(now, contexts_.all_free() && (issue_.empty() || issue_.front_is_ready()));
  issue_.look_ahead();
  due_.start = contexts_.next_start_after(now);
  due_.here = next_here();
  egress_.look(machine_.flow.bubble() && (issue_.front_is_ready() || entry_.waiting()));
  note_state(now);
}

TileState Tile::classify(bool blocked) const {
  if (help_.shading()) return TileState::kShading;
  if (contexts_.testing()) return TileState::kTesting;
  if (contexts_.fetching()) return TileState::kMemory;
  if (blocked) return TileState::kLink;
  if (!issue_.empty()) return issue_.front_is_ready() ? TileState::kLink : TileState::kMemory;
  if (room_.short_of_room()) return TileState::kStorage;
  if (!resource_.idle() && resource_.packets_in_flight() > 0 && logic_.free.none()) return TileState::kCredits;
  return TileState::kIdle;
}

// ---- the end, good or bad

ResourceStatistics Tile::statistics() const {
  ResourceStatistics s = sink_.statistics();
  s.hops = egress_.hops();
  s.visits += dispatch_.idle_visits();
  s.bubbles += dispatch_.idle_visits();
  s.seen_rays += dispatch_.idle_visit_rays();
  return s;
}

ResourceAgent::Work Tile::work() const {
  Work out{tester_.busy_units(), tester_.busy_reads(), dispatch_.busy()};
  read_energy(tester_, sink_.statistics(), shapes_.counts(), out);
  return out;
}

TileResult Tile::result() const {
  TileResult t;
  ledger_.fill_in(t);
  t.dispatch.busy = dispatch_.busy();
  t.sent = egress_.sent();
  t.shapes = shapes_.counts();
  t.strip_reads = shapes_.reads();
  t.spilled = room_.moved();
  t.transformed_rays = transforms_.bytes();
  t.round_trips = retirement_.trips().latency();
  t.collection_ages = resource_.collections().ages();
  t.packet_cycles = retirement_.trips().packet_cycles();
  return t;
}

bool Tile::at_rest() const {
  return logic_.at_rest() && entry_.at_rest() && entry_.packets_out() == 0 && issue_.empty() && egress_.empty();
}

std::string Tile::describe() const {
  if (at_rest()) return "";
  std::string text = logic_.describe() + fmt::format(", {} to be issued", issue_.size());
  if (!entry_.at_rest()) text += ", new rays wait for packets or records";
  if (entry_.packets_out() > 0) text += fmt::format(", {} packets of new rays out", entry_.packets_out());
  return text + egress_.describe();
}

void Tile::read(Cycle at, std::span<std::uint64_t> row) {
  const auto put = [&](ResourceCounter counter, std::uint64_t value) { row[counter_index(counter)] = value; };
  read_units(tester_, at, row);
  put(ResourceCounter::kDispatch, dispatch_.busy_before(at));
  put(ResourceCounter::kIds, samples_.ids_before(at));
  put(ResourceCounter::kCollections, samples_.collections_before(at));
  put(ResourceCounter::kPackets, retirement_.trips().packet_cycles(at));
  put(ResourceCounter::kCompleted, sink_.statistics().rays_completed);
  put(ResourceCounter::kTested, sink_.statistics().local_rays);
  put(ResourceCounter::kHeld, travelling_.held(at));
  read_ports(ports_.out, at, kFirstPortCounter, row);
}

void Tile::close(Cycle end) {
  samples_.close(end, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  note_blocked(end);
  ledger_.close(end);
  tester_.close(end);
  dispatch_.close(end);
}

// ---- when a resource has stopped, this one or another

/// Stops this resource. Ray control learns only after some time that it is silent (ShadingAgent).
void Tile::stop(Cycle now) {
  logic_.stop();
  discard_work(now);
  help_.stop();
  completions_.port().notify(CompletedRays::Note::kLastBeat, now);
}

void Tile::on_order(NewRays::Order order, Cycle now) {
  if (order == NewRays::Order::kDiscard) {
    logic_.drain();
    discard_work(now);
    return;
  }
  fault_.begin_anew();
  logic_.resume(fault_.stopped());
}

/// Discards all work of this resource. Packets of others that are in test here go on as they are.
void Tile::discard_work(Cycle now) {
  fault_.count_discarded(resource_.discard());
  room_.discard();
  logic_.admission.clear();
  issue_.discard(now);
  contexts_.discard(now);
  completions_.discard();
  contexts_.forget_ready();
}

/// Nothing of its own is under way. Packets of others that are here count for their owners.
bool Tile::drained() const {
  return logic_.all_home() && shapes_.fetches() == 0 && room_.reads() == 0 && any_hit_.under_way() == 0;
}

}  // namespace carousel::ringbus::cycle
