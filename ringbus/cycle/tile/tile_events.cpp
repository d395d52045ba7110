// When a resource next has something to do, and what has to be done then. Most events concern one part of it: a packet
// passes by, shapes come for rays in subtrees, tests begin whose packet dispatch has read, a ray goes on. Then that
// part of a step is done by itself (tests/ringbus/cycle/cycle_engine_test.cpp, PartsOfAStepDoAsMuchAsTheWhole); for all
// others there is step().
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

// ---- the next event

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

// ---- the way through events

/// While nothing waits to leave, packets that pass by before `limit` go from link to link: as in pass_on(), without
/// what changes nothing then.
void Tile::pass_ahead(Cycle limit) {
  if (steps_always_ || !cuts_through_ || waits_for_place_ || link_state_from_ != kNever ||
      ledger_.state() == TileState::kLink)
    return;
  for (;;) {
    std::size_t first = 0;
    for (std::size_t d = 1; d < ports_.in.size(); ++d)
      if (ports_.in[d].next() < ports_.in[first].next()) first = d;
    InPort& in = ports_.in[first];
    OutPort& out = ports_.out[first];
    const Cycle at = in.next();
    if (at >= limit || at <= now_ || samples_.due(at) || in.front().skip == 0 || !out.open(at, 1)) return;
    Token token = in.take(at);
    --token.skip;
    out.launch(token, at, token.skip > 0);
    now_ = at - 1;  // in the same cycle, something may arrive at other ports
  }
}

void Tile::run(Cycle end) {
  for (;;) {
    Cycle links = next_on_links();
    const Cycle others = std::min({next_here_, next_start_, side_arrival_}), until = std::min(others, end);
    if (!may_send_ && links < until && links < visits_.next()) {
      pass_ahead(std::min(until, visits_.next()));
      links = next_on_links();
    }
    const Cycle now = std::min(links, others);
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

// ---- parts of a step, at a time at which nothing is due but what their names say. They return false if there is more
// to do; then a step has to go on from there.

/// Takes in shapes for rays in subtrees.
bool Tile::take_shapes(Cycle now) {
  if (next_but_shapes() <= now || logic_.draining()) return false;  // it may be drained with the last fetch
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
  for (OutPort& out : ports_.out)
    if (wants_credit_ || !out.empty()) out.take_credits(now);
  do {
    cut_through(now, true);
    for (const InPort& in : ports_.in) {
      if (in.next() > now || !stops_here(in)) continue;
      if (dispatch_free_ <= now) return false;
      next_here_ = std::min(next_here_, dispatch_free_);
    }
  } while (send(now));
  now_ = now;
  const bool was_blocked = ledger_.state() == TileState::kLink || link_state_from_ != kNever;
  look_at_links();
  if (was_blocked || blocked_from_ != kNever) note_state(now);  // else it has not changed
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
  const bool link_is_next = state != TileState::kLink && blocked_from_ != kNever && classify(true) == TileState::kLink;
  link_state_from_ = link_is_next ? blocked_from_ : kNever;
}

/// Before anything changes at `now`.
void Tile::note_blocked(Cycle now) {
  if (link_state_from_ < now) ledger_.enter(TileState::kLink, link_state_from_);
}

}  // namespace carousel::ringbus::cycle
