#include "ringbus/cycle/tile/tile.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

namespace {

SubtreeWalk::StepCycles step_cycles(const TestersConfig& testers) {
  SubtreeWalk::StepCycles out;
  for (const auto [kind, units] : testers.units) out[kind] = static_cast<std::uint64_t>(units.latency_cycles);
  // Where a shader worker decides, the ray goes on in the meantime and waits at the end.
  if (testers.any_hit != TestersConfig::AnyHit::kInline) out[UnitKind::kAnyHit] = 0;
  return out;
}

}  // namespace

Tile::Tile(ResourceId id, CycleMachine& machine, float scene_size, bool statistics, TraceWindow window, Ports ports)
    : machine_(machine),
      id_(id),
      trace_(id.value, window),
      transforms_(machine.config.accuracy, machine.accel, machine.stores[id.value]->slots()),
      walk_(machine.accel, step_cycles(testers_of(machine.config, id)), transforms_),
      resource_(resource_settings(machine.config, scene_size), machine.accel, *machine.stores[id.value],
                {statistics ? &sink_ : nullptr, &walk_, &transforms_, ports.questions != nullptr}),
      ports_(std::move(ports)),
      tester_(testers_of(machine.config, id), machine.config.cull_planes.order, machine.config.rays.reads_per_cycle),
      shapes_(machine.config.memory, ports_),
      completed_port_(machine.config, ports_),
      help_(machine.config, ports_),
      packet_size_(machine.config),
      link_bytes_(static_cast<Cycle>(machine.config.topology.link.bytes_per_cycle)),
      ids_per_cycle_(static_cast<Cycle>(machine.config.packets.ids_per_cycle)),
      issue_places_(static_cast<std::size_t>(machine.config.memory.fetch_ahead) + 1),
      stays_(machine.stays()),
      visit_all_(machine.config.topology.visit == Visit::kAll),
      cuts_through_(!visit_all_ && ports_.out_to.empty()),
      fetch_by_resource_(machine.config.memory.fetch == MemoryConfig::Fetch::kResource),
      bubble_(machine.config.topology.flow == Flow::kBubble),
      free_(machine.topology.directions()),
      contexts_(static_cast<std::size_t>(testers_of(machine.config, id).contexts)),
      trips_(static_cast<std::uint32_t>(id.value * machine.topology.directions() * machine.packets_per_direction()),
             machine.topology.directions() * machine.packets_per_direction()) {
  const FaultsConfig::Resource& fault = machine.config.faults.resource;
  pauses_ = fault.kind == FaultsConfig::Resource::Kind::kPause && fault.number == id.value;
  stops_ = fault.kind == FaultsConfig::Resource::Kind::kStop && fault.number == id.value;
  pause_after_ = static_cast<std::uint64_t>(fault.after_rays);
  for (std::uint32_t i = 0; i < machine.packets.size(); ++i)
    if (machine.packets[i].owner == id) free_[machine.packets[i].direction].push_back(PacketId(i));
}

// ---- time

Cycle Tile::next() const {
  return std::min(next_arrival(), next_beside_ring());
}

// What is not later than the last step was done in it, or waits for one of the others.
Cycle Tile::next_arrival() const {
  Cycle first = kNever;
  for (const InPort& in : ports_.in)
    if (const Cycle at = in.next(); at > now_ && at < first) first = at;
  return first;
}

Cycle Tile::next_beside_ring() const {
  Cycle first = next_here_;
  const auto consider = [&](Cycle at) {
    if (at > now_ && at < first) first = at;
  };
  consider(ports_.new_rays->next());
  consider(shapes_.next());
  consider(help_.next());
  if (ports_.answers != nullptr) consider(ports_.answers->next());
  if (may_send_)
    for (const OutPort& out : ports_.out) consider(out.next(wants_credit()));
  return first;
}

bool Tile::wants_credit() const {
  return bubble_ && !issue_.empty() && issue_.front().ready();
}

Cycle Tile::next_egress() const {
  Cycle first = kNever;
  const auto consider = [&](Cycle at) {
    if (at > now_ && at < first) first = at;
  };
  for (const Context& context : contexts_)
    if (context.phase == Context::Phase::kComputing || context.subtree) consider(context.done);
  if (dispatch_free_ > now_ && dispatch_free_ < first && dispatch_wanted()) first = dispatch_free_;
  return first;
}

bool Tile::dispatch_wanted() const {
  // Collections that are not full go when the handler has nothing else to do.
  if (issue_.empty() ? !resource_.idle() : issue_.front().ready()) return true;
  return std::any_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now_; });
}

void Tile::run(Cycle end) {
  Cycle rest = next_beside_ring();  // what passes by does not change it
  for (;;) {
    const Cycle arrival = next_arrival(), now = std::min(arrival, rest);
    if (now >= end) return;
    // Not with the bubble rule, under which what waits to get in must see every credit.
    if (now < rest && !bubble_ && cut_through(now, true)) continue;
    step(now);
    rest = next_beside_ring();
  }
}

void Tile::step(Cycle now) {
  now_ = now;
  for (OutPort& out : ports_.out) out.take_credits(now);
  if (stops_ && sink_.statistics().rays_completed >= pause_after_) stop(now);
  take_answers(now);
  take_opacities(now);
  take_new_rays(now);
  bool again = true;
  while (again) {
    again = finish_tests(now);
    again |= help_.step(now, testers_free());
    again |= cut_through(now, false);
    again |= handle(now);
    again |= admit();
    again |= fill_issue(now);
    again |= send(now);
  }
  hand_over(now);
  if (drains_ && !told_drained_ && drained()) {
    told_drained_ = true;
    completed_port_.notify(CompletedRays::Note::kDrained, now);
  }
  if (pauses_ && sink_.statistics().rays_completed >= pause_after_) {
    // The handler takes nothing up; what is in test is finished.
    dispatch_free_ = std::max(dispatch_free_, now) + static_cast<Cycle>(machine_.config.faults.resource.cycles);
    pauses_ = false;
  }
  const TileState state = classify(now);
  clock_.enter(state, now);
  help_.notify(now, state != TileState::kTesting && state != TileState::kMemory);
  next_here_ = next_egress();
  may_send_ = wants_credit() ||
              std::any_of(ports_.out.begin(), ports_.out.end(), [](const OutPort& out) { return !out.empty(); });
}

TileState Tile::classify(Cycle now) const {
  if (help_.shading()) return TileState::kShading;
  bool fetching = false, computing = false;
  for (const Context& c : contexts_) {
    computing |=
        c.phase == Context::Phase::kComputing || (c.phase == Context::Phase::kFetching && c.subtree && c.done > now);
    fetching |= c.phase == Context::Phase::kFetching;
  }
  if (computing) return TileState::kTesting;
  if (fetching) return TileState::kMemory;
  for (const OutPort& out : ports_.out)
    if (out.blocked()) return TileState::kLink;
  if (!issue_.empty()) return issue_.front().ready() ? TileState::kLink : TileState::kMemory;
  if (storage_full_) return TileState::kStorage;
  if (!resource_.idle() && resource_.packets_in_flight() > 0 &&
      std::all_of(free_.begin(), free_.end(), [](const std::vector<PacketId>& f) { return f.empty(); }))
    return TileState::kCredits;
  return TileState::kIdle;
}

// ---- what comes in beside the ring

void Tile::take_new_rays(Cycle now) {
  while (ports_.new_rays->next() <= now) {
    NewRays rays = ports_.new_rays->take();
    if (rays.order != NewRays::Order::kTake)
      on_order(rays.order, now);
    else if (!only_forwards())
      waiting_.push_back(std::move(rays));
  }
}

bool Tile::admit() {
  bool moved = false;
  while (!waiting_.empty()) {
    std::vector<RayId>& ids = waiting_.front().ids;
    const std::size_t count = std::min(ids.size(), resource_.admissible());
    storage_full_ = count < ids.size();
    if (count == 0) return moved;
    resource_.admit(std::span(ids).first(count));
    trace_.note(now_, StepKind::kNewRays, 0, count);
    ids.erase(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count));
    if (ids.empty()) waiting_.pop_front();
    moved = true;
  }
  return moved;
}

// ---- what leaves

bool Tile::send(Cycle now) {
  bool moved = false;
  for (OutPort& out : ports_.out) moved |= out.send(now);
  return moved;
}

void Tile::hand_over(Cycle now) {
  if (done_.empty()) return;
  sink_.record({.kind = EventKind::kComplete, .resource = id_, .rays = static_cast<std::uint32_t>(done_.size())});
  trace_.note(now, StepKind::kComplete, 0, done_.size());
  completed_port_.send(done_, done_slots_, now);
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
  t.states = clock_.times();
  tester_.account(t);
  t.dispatch.busy = dispatch_busy_;
  t.transformed_rays = transforms_.bytes();
  t.round_trips = trips_.latency();
  t.packet_cycles = trips_.packet_cycles();
  return t;
}

bool Tile::at_rest() const {
  return resource_.idle() && resource_.packets_in_flight() == 0 && waiting_.empty() && issue_.empty() &&
         std::all_of(ports_.out.begin(), ports_.out.end(), [](const OutPort& out) { return out.empty(); });
}

std::string Tile::describe() const {
  if (at_rest()) return "";
  std::string text = fmt::format("resource {}: {} collections with {} memberships, {} packets out, {} to be issued",
                                 id_.value, resource_.collections().collections(),
                                 resource_.collections().memberships(), resource_.packets_in_flight(), issue_.size());
  for (std::size_t exit = 0; exit < ports_.out.size(); ++exit)
    if (const std::string packet = blocked(exit); !packet.empty())
      text += fmt::format("; {} cannot leave, {} more behind it", packet, ports_.out[exit].egress() - 1);
  return text;
}

std::string Tile::blocked(std::size_t exit) const {
  const OutPort& out = ports_.out[exit];
  if (!out.blocked()) return "";
  const Packet& packet = machine_.packet(out.front());
  std::string text = fmt::format("packet {} of resource {}", out.front().value, packet.owner.value);
  if (!packet.members.empty()) {
    const RayIdLayout& layout = resource_.rays().layout();
    text += fmt::format(" (first ray {}:{})", layout.owner(packet.members[0].ray).value,
                        layout.slot(packet.members[0].ray));
  }
  return text;
}

}  // namespace carousel::ringbus::cycle
