#include "ringbus/cycle/tile.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

namespace {

SubtreeWalk::StepCycles step_cycles(const TestersConfig& testers) {
  const auto latency = [](const TesterUnits& units) { return static_cast<std::uint64_t>(units.latency_cycles); };
  return {latency(testers.box), latency(testers.triangle), latency(testers.transform)};
}

constexpr std::uint32_t kContextTag = 1u << 31;   // of a fetch: for a context, not for the issue queue

}  // namespace

Tile::Tile(ResourceId id, CycleMachine& machine, float scene_size, bool statistics, TraceWindow window, Ports ports)
    : machine_(machine),
      id_(id),
      trace_(id.value, window),
      walk_(machine.accel, step_cycles(testers_of(machine.config, id))),
      resource_(machine.config, machine.accel, scene_size, *machine.stores[id.value], statistics ? &sink_ : nullptr),
      ports_(std::move(ports)),
      tester_(testers_of(machine.config, id)),
      shapes_(machine.config.memory, ports_),
      completed_port_(machine.config, ports_),
      help_(machine.config, ports_),
      packet_size_(machine.config),
      link_bytes_(static_cast<Cycle>(machine.config.topology.link.bytes_per_cycle)),
      ids_per_cycle_(static_cast<Cycle>(machine.config.packets.ids_per_cycle)),
      issue_places_(static_cast<std::size_t>(machine.config.memory.fetch_ahead) + 1),
      stays_(machine.stays()),
      visit_all_(machine.config.topology.visit == Visit::kAll),
      fetch_by_resource_(machine.config.memory.fetch == MemoryConfig::Fetch::kResource),
      bubble_(machine.config.topology.flow == Flow::kBubble),
      free_(machine.topology.directions()),
      contexts_(static_cast<std::size_t>(testers_of(machine.config, id).contexts)),
      trips_(static_cast<std::uint32_t>(id.value * machine.topology.directions() * machine.packets_per_direction()),
             machine.topology.directions() * machine.packets_per_direction()) {
  resource_.set_subtree_tracer(&walk_);
  for (std::uint32_t i = 0; i < machine.packets.size(); ++i)
    if (machine.packets[i].owner == id) free_[machine.packets[i].direction].push_back(PacketId(i));
}

// ---- time

Cycle Tile::next() const {
  // What is not later than the last step was done in it, or waits for one of the others.
  Cycle first = kNever;
  const auto consider = [&](Cycle at) {
    if (at > now_ && at < first) first = at;
  };
  for (const InPort& in : ports_.in) consider(in.next());
  const bool want_credit = bubble_ && !issue_.empty() && issue_.front().ready;
  for (const OutPort& out : ports_.out) consider(out.next(want_credit));
  consider(ports_.new_rays->next());
  consider(shapes_.next());
  consider(help_.next());
  for (const Context& context : contexts_)
    if (context.phase == Context::Phase::kComputing || context.subtree) consider(context.done);
  if (handler_free_ > now_ && handler_free_ < first && handler_wanted()) first = handler_free_;
  return first;
}

bool Tile::handler_wanted() const {
  // Collections that are not full go when the handler has nothing else to do.
  if (issue_.empty() ? !resource_.idle() : issue_.front().ready) return true;
  return std::any_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now_; });
}

void Tile::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void Tile::step(Cycle now) {
  now_ = now;
  for (OutPort& out : ports_.out) out.take_credits(now);
  take_answers(now);
  take_new_rays(now);
  bool again = true;
  while (again) {
    again = finish_tests(now);
    again |= help_.step(now, testers_free());
    again |= cut_through(now);
    again |= handle(now);
    again |= admit();
    again |= fill_issue(now);
    again |= send(now);
  }
  hand_over(now);
  const TileState state = classify(now);
  clock_.enter(state, now);
  help_.tell(now, state != TileState::kTesting && state != TileState::kMemory);
}

TileState Tile::classify(Cycle now) const {
  if (help_.shading()) return TileState::kShading;
  bool fetching = false, computing = false;
  for (const Context& c : contexts_) {
    computing |= c.phase == Context::Phase::kComputing || (c.phase == Context::Phase::kFetching && c.subtree && c.done > now);
    fetching |= c.phase == Context::Phase::kFetching;
  }
  if (computing) return TileState::kTesting;
  if (fetching) return TileState::kMemory;
  for (const OutPort& out : ports_.out)
    if (out.blocked()) return TileState::kLink;
  if (!issue_.empty()) return issue_.front().ready ? TileState::kLink : TileState::kMemory;
  if (storage_full_) return TileState::kStorage;
  if (!resource_.idle() && resource_.packets_in_flight() > 0 &&
      std::all_of(free_.begin(), free_.end(), [](const std::vector<PacketId>& f) { return f.empty(); }))
    return TileState::kCredits;
  return TileState::kIdle;
}

// ---- what comes in beside the ring

void Tile::take_new_rays(Cycle now) {
  while (ports_.new_rays->next() <= now) waiting_.push_back(ports_.new_rays->take());
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

void Tile::fetch(const ShapeSpan& strip, std::uint32_t tag, Cycle now) {
  shapes_.request(strip, tag, now);
  // Its place in the buffer is taken now; whoever wants it meanwhile waits behind this one.
  shapes_.keep(strip);
}

void Tile::take_answers(Cycle now) {
  while (shapes_.next() <= now) {
    const std::uint32_t tag = shapes_.take();
    if ((tag & kContextTag) == 0) {
      for (Issue& issue : issue_) issue.ready |= issue.tag == tag;
      continue;
    }
    Context& context = contexts_[tag & ~kContextTag];
    --context.outstanding;
    if (!context.strips.empty()) {
      begin_fetch(context, context.strips.back(), now);
      context.strips.pop_back();
    }
    if (context.outstanding > 0) continue;
    context.phase = Context::Phase::kComputing;
    context.done = context.subtree ? std::max(context.done, now + tester_.box.latency())
                                   : tester_.strip(now, context.counts);
  }
}

// ---- tests

bool Tile::testers_free() const {
  return std::all_of(contexts_.begin(), contexts_.end(), [](const Context& c) { return c.phase == Context::Phase::kFree; });
}

Tile::Context* Tile::free_context() {
  if (help_.holds()) return nullptr;
  for (Context& context : contexts_)
    if (context.phase == Context::Phase::kFree) return &context;
  return nullptr;
}

void Tile::begin_fetch(Context& context, const ShapeSpan& strip, Cycle now) {
  ++context.outstanding;
  fetch(strip, kContextTag | static_cast<std::uint32_t>(&context - contexts_.data()), now);
}

void Tile::begin_test(Context& context, PacketId id, Cycle at) {
  Packet& packet = machine_.packet(id);
  resource_.test(packet);
  context.packet = id;
  context.counts = resource_.last_tests();
  context.subtree = resource_.is_treelet(packet.key);
  context.phase = Context::Phase::kComputing;
  if (context.subtree) {
    // Each ray fetches the strip it needs next, so as many fetches are under way as there are rays.
    context.done = tester_.walk(at, context.counts, walk_.account().chain);
    context.strips.clear();
    for (const accel::NodeKey key : walk_.account().strips)
      if (const ShapeSpan strip = machine_.memory.strip(key); !shapes_.has(strip)) context.strips.push_back(strip);
    std::reverse(context.strips.begin(), context.strips.end());
    const std::size_t together = std::min({resource_.last_rays(), kSubtreeFetches, context.strips.size()});
    for (std::size_t i = 0; i < together; ++i) {
      begin_fetch(context, context.strips.back(), at);
      context.strips.pop_back();
    }
  } else if (const ShapeSpan strip = machine_.memory.strip(packet.key); fetch_by_resource_ && !shapes_.has(strip)) {
    begin_fetch(context, strip, at);
  } else {
    context.done = tester_.strip(at, context.counts);
  }
  if (context.outstanding > 0) context.phase = Context::Phase::kFetching;
}

bool Tile::finish_tests(Cycle now) {
  bool moved = false;
  for (Context& context : contexts_) {
    if (context.phase != Context::Phase::kComputing || context.done > now) continue;
    end_test(context, now);
    moved = true;
  }
  return moved;
}

void Tile::end_test(Context& context, Cycle now) {
  const PacketId id = context.packet;
  const Packet& packet = machine_.packet(id);
  trace_.note(now, StepKind::kTested, id.value, packet.members.size());
  context.phase = Context::Phase::kFree;
  context.subtree = false;
  if (packet.owner == id_ && (stays_ || machine_.topology.hops(packet) == 0)) {
    occupy_handler(now, packet.members.size());
    come_home(id);
  } else {
    depart(id, now, true);
  }
}

// ---- packets

std::size_t Tile::exit_of(const Packet& packet) const {
  if (ports_.out_to.empty()) return machine_.topology.groups() > 0 ? 0 : packet.direction;
  return ports_.out_to[machine_.topology.next(packet, id_).value];
}

void Tile::depart(PacketId id, Cycle ready, bool reserved) {
  const Packet& packet = machine_.packet(id);
  OutPort& out = ports_.out[exit_of(packet)];
  if (reserved) out.release();
  Token token{id, 0, 1, static_cast<std::uint16_t>(packet.members.size())};
  token.link_cycles = static_cast<std::uint16_t>(
      ceil_div(packet_size_.bytes(packet, machine_.memory, resource_.is_treelet(packet.key)), link_bytes_));
  token.skip = machine_.topology.skip(packet, id_);
  out.push(token, ready, !visit_all_ && token.skip > 0);
}

void Tile::come_home(PacketId id) {
  Packet& packet = machine_.packet(id);
  trace_.note(now_, StepKind::kRetire, id.value, packet.members.size());
  trips_.return_home(id.value, now_);
  resource_.retire(packet);
  free_[packet.direction].push_back(id);
}

void Tile::occupy_handler(Cycle now, std::size_t ids) {
  const Cycle cycles = std::max<Cycle>(1, ceil_div(ids, ids_per_cycle_));
  handler_free_ = std::max(handler_free_, now) + cycles;
  handler_busy_ += cycles;
}

bool Tile::cut_through(Cycle now) {
  if (visit_all_ || !ports_.out_to.empty()) return false;
  bool moved = false;
  for (std::size_t d = 0; d < ports_.in.size(); ++d) {
    InPort& in = ports_.in[d];
    while (in.next() <= now && in.front().skip > 0 && ports_.out[d].has_place()) {
      Token token = in.take(now);
      --token.skip;
      ports_.out[d].push(token, now, token.skip > 0);
      moved = true;
    }
  }
  return moved;
}

bool Tile::handle(Cycle now) {
  if (handler_free_ > now) return false;
  for (std::size_t i = 0; i < ports_.in.size(); ++i) {
    const std::size_t d = next_in_ + i < ports_.in.size() ? next_in_ + i : next_in_ + i - ports_.in.size();
    if (ports_.in[d].next() > now || !handle_arrival(d, now)) continue;
    next_in_ = d + 1 == ports_.in.size() ? 0 : d + 1;
    return true;
  }
  return handle_issue(now);
}

bool Tile::handle_arrival(std::size_t d, Cycle now) {
  InPort& in = ports_.in[d];
  if (in.front().skip > 0) {
    if (!visit_all_ || !ports_.out[d].has_place()) return false;
    Token token = in.take(now);
    --token.skip;
    ++passed_;
    passed_rays_ += token.rays;
    occupy_handler(now, token.rays);
    ports_.out[d].push(token, handler_free_, false);
    return true;
  }
  const PacketId id = in.front().packet;
  Packet& packet = machine_.packet(id);
  if (packet.owner == id_) {
    in.take(now);
    occupy_handler(now, packet.members.size());
    come_home(id);
    return true;
  }
  OutPort& out = ports_.out[exit_of(packet)];
  if (!out.has_place()) return false;
  const bool tested = packet.kind == PacketKind::kTest && machine_.topology.wanted(packet, id_);
  Context* context = tested ? free_context() : nullptr;
  if (tested && context == nullptr) return false;
  in.take(now);
  trace_.note(now, StepKind::kTake, id.value, packet.members.size());
  occupy_handler(now, packet.members.size());
  if (tested) {
    out.reserve();
    begin_test(*context, id, handler_free_);
  } else {
    if (packet.kind == PacketKind::kMemberships && packet.home == id_) {
      resource_.join(packet);
    } else {
      ++passed_;
      passed_rays_ += packet.members.size();
    }
    depart(id, handler_free_, false);
  }
  return true;
}

// ---- issuing

bool Tile::may_inject(const Packet& packet) const {
  const OutPort& out = ports_.out[exit_of(packet)];
  // The bubble rule also leaves a place for the ring's own traffic.
  return out.has_place() && (!bubble_ || !ports_.out_to.empty() || out.spare_places() >= 2);
}

bool Tile::handle_issue(Cycle now) {
  if (issue_.empty() || !issue_.front().ready) return false;
  const PacketId id = issue_.front().packet;
  Packet& packet = machine_.packet(id);
  const bool travels = !stays_ && machine_.topology.hops(packet) > 0;
  if (travels && !may_inject(packet)) return false;
  const bool tested = packet.kind == PacketKind::kTest && machine_.topology.wanted(packet, id_);
  Context* context = tested ? free_context() : nullptr;
  if (tested && context == nullptr) return false;
  issue_.pop_front();
  trips_.leave(id.value, now);
  trace_.note(now, StepKind::kIssue, id.value, packet.members.size());
  occupy_handler(now, packet.members.size());
  if (tested) {
    if (travels) ports_.out[exit_of(packet)].reserve();
    begin_test(*context, id, handler_free_);
    return true;
  }
  if (packet.kind == PacketKind::kTest) {
    ++passed_;
    passed_rays_ += packet.members.size();
  }
  depart(id, handler_free_, false);
  return true;
}

std::optional<PacketId> Tile::free_packet() {
  for (std::size_t i = 0; i < free_.size(); ++i) {
    std::vector<PacketId>& free = free_[(next_direction_ + i) % free_.size()];
    if (free.empty()) continue;
    const PacketId id = free.back();
    free.pop_back();
    next_direction_ = (next_direction_ + i + 1) % free_.size();
    return id;
  }
  return std::nullopt;
}

bool Tile::fill_issue(Cycle now) {
  bool moved = false;
  while (issue_.size() < issue_places_ && !resource_.idle()) {
    // Collections that are not full go only when there is nothing better to do: waiting fills them.
    const bool nothing_else =
        issue_.empty() && handler_free_ <= now && testers_free() && !help_.holds() &&
        std::none_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now; });
    const std::optional<PacketId> id = free_packet();
    if (!id) return moved;
    Packet& packet = machine_.packet(*id);
    const Resource::Offer offer = resource_.offer(nothing_else, packet);
    storage_full_ = offer == Resource::Offer::kStorage;
    if (offer != Resource::Offer::kPacket) {
      free_[packet.direction].push_back(*id);
      return moved;
    }
    moved = true;
    Issue issue{*id, next_tag_, machine_.memory.strip(packet.key), true};
    const bool brings_shapes = packet.kind == PacketKind::kTest && !fetch_by_resource_ && !resource_.is_treelet(packet.key);
    if (brings_shapes && !shapes_.has(issue.strip)) {
      issue.ready = false;
      fetch(issue.strip, issue.tag, now);
      next_tag_ = (next_tag_ + 1) & ~kContextTag;
    }
    issue_.push_back(issue);
  }
  return moved;
}

bool Tile::send(Cycle now) {
  bool moved = false;
  for (OutPort& out : ports_.out) moved |= out.send(now);
  return moved;
}

void Tile::hand_over(Cycle now) {
  HitBatch& done = resource_.completed();
  if (done.empty()) return;
  sink_.record({.kind = EventKind::kComplete, .resource = id_, .rays = static_cast<std::uint32_t>(done.size())});
  trace_.note(now, StepKind::kComplete, 0, done.size());
  completed_port_.send(done, resource_.freed_slots(), now);
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
  t.box.busy = tester_.box.busy();
  t.triangle.busy = tester_.triangle.busy();
  t.transform.busy = tester_.transform.busy();
  t.handler.busy = handler_busy_;
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
  std::string text = fmt::format("resource {}: {} collections with {} memberships, {} packets out, {} to be issued", id_.value,
                                 resource_.collections().collections(), resource_.collections().memberships(),
                                 resource_.packets_in_flight(), issue_.size());
  for (std::size_t exit = 0; exit < ports_.out.size(); ++exit)
    if (const std::string packet = blocked(exit); !packet.empty())
      text += fmt::format("; {} cannot leave, {} more behind it", packet, ports_.out[exit].in_hand() - 1);
  return text;
}

std::string Tile::blocked(std::size_t exit) const {
  const OutPort& out = ports_.out[exit];
  if (!out.blocked()) return "";
  const Packet& packet = machine_.packet(out.front());
  std::string text = fmt::format("packet {} of resource {}", out.front().value, packet.owner.value);
  if (!packet.members.empty()) {
    const RayIdLayout& layout = resource_.rays().layout();
    text += fmt::format(" (first ray {}:{})", layout.owner(packet.members[0].ray).value, layout.slot(packet.members[0].ray));
  }
  return text;
}

}  // namespace carousel::ringbus::cycle
