// When a resource next has something to do, and what has to be done then. Most events concern one part of it: a packet
// passes by, shapes come for rays in subtrees, tests begin whose packet dispatch has read, a ray goes on. Then that
// part of a step is done by itself (tests/ringbus/cycle/cycle_engine_test.cpp, PartsOfAStepDoAsMuchAsTheWhole); for all
// others there is step().
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

// ---- the next event

Cycle Tile::next_here() const {
  Cycle first = contexts_.next_end_after(now_);
  const auto consider = [&](Cycle at) {
    if (at > now_ && at < first) first = at;
  };
  consider(issue_.next_partial());
  consider(help_.ends());
  consider(entry_.next());
  const Cycle free = dispatch_.free_at();
  if (free <= now_ || free >= first) return first;
  // Collections that are not full may go when the dispatch stage has nothing else to do.
  const bool partial = issue_.waits_for_idle() && issue_.empty() && !resource_.idle();
  return partial || dispatcher_.is_wanted(now_) ? free : first;
}

// ---- the way through events

void Tile::run(Cycle end) {
  SubtreeVisits& visits = contexts_.visits();
  for (;;) {
    Cycle links = next_on_links();
    const Cycle others = std::min({due_.here, due_.start, due_.side}), until = std::min(others, end);
    if (!egress_.may_send() && links < until && links < visits.next()) {
      pass_ahead(std::min(until, visits.next()));
      links = next_on_links();
    }
    const Cycle now = std::min(links, others);
    visits.forget_news();
    if (const Cycle event = visits.run_before(std::min(now, end)); event != kNever) {
      if (visits.has_news()) {
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
      due_.next = std::min(now, visits.next());
      return;
    }
    if (samples_.due(now)) [[unlikely]]
      sample(now);
    // Where a ray's test ends in this cycle, it comes first, as in every step.
    if (!steps_always_ && now < std::min(due_.here, visits.next()) && (due_.side > now || take_shapes(now)) &&
        (due_.start > now || start_alone(now)) && (links > now || pass_on(now)))
      continue;
    step(now);
  }
}

/// While nothing waits to leave, packets that pass by before `limit` go from link to link: as in pass_on(), without
/// what changes nothing then.
void Tile::pass_ahead(Cycle limit) {
  if (steps_always_ || !dispatcher_.cuts_through() || egress_.waits_for_place() || due_.link_state != kNever ||
      ledger_.state() == TileState::kLink)
    return;
  for (;;) {
    std::size_t first = 0;
    for (std::size_t d = 1; d < ports_.in.size(); ++d)
      if (ports_.in[d].next() < ports_.in[first].next()) first = d;
    InPort& in = ports_.in[first];
    const Cycle at = in.next();
    if (at >= limit || at <= now_ || samples_.due(at) || !dispatcher_.passes_by(in.front())) return;
    OutPort& out = dispatcher_.way_of(first, in.front());
    if (!out.open(at, 1)) return;
    Token token = in.take(at);
    const bool through = dispatcher_.pass_by(token);
    out.launch(token, at, through);
    now_ = at - 1;  // in the same cycle, something may arrive at other ports
  }
}

// ---- parts of a step, at a time at which nothing is due but what their names say. They return false if there is more
// to do; then a step has to go on from there.

/// Takes in shapes for rays in subtrees.
bool Tile::take_shapes(Cycle now) {
  if (next_but_shapes() <= now || logic_.draining()) return false;  // it may be drained with the last fetch
  SubtreeVisits& visits = contexts_.visits();
  note_blocked(now);
  const bool tested = visits.testing();
  shapes_.take_answers(now);
  visits.serve(now);
  if (visits.has_news() || !shapes_.spill_answers().empty()) return false;
  due_.side = next_on_side();
  if (tested != visits.testing()) note_state(now);
  return true;
}

/// Begins tests of packets that dispatch has read.
bool Tile::start_alone(Cycle now) {
  note_blocked(now);
  contexts_.start(now);
  const Cycle ends = contexts_.next_end_after(0);
  if (contexts_.visits().has_news() || ends <= now) return false;
  due_.start = contexts_.next_start_after(now);
  due_.here = std::min(due_.here, ends);
  note_state(now);
  return true;
}

/// Lets packets pass by the resource and leave.
bool Tile::pass_on(Cycle now) {
  if (egress_.waits_for_place()) return false;
  note_blocked(now);
  egress_.take_wanted_credits(now);
  do {
    dispatcher_.cut_through(now, true);
    for (const InPort& in : ports_.in) {
      if (in.next() > now || !dispatcher_.stops_here(in)) continue;
      if (dispatch_.free_at() <= now) return false;
      due_.here = std::min(due_.here, dispatch_.free_at());
    }
  } while (egress_.send(now));
  now_ = now;
  const bool was_blocked = ledger_.state() == TileState::kLink || due_.link_state != kNever;
  egress_.look();
  if (was_blocked || egress_.blocked_from() != kNever) note_state(now);  // else it has not changed
  return true;
}

// ---- what its time is accounted to

/// The state at the end of an event. It stays until the next one, unless a link becomes blocked before.
void Tile::note_state(Cycle now) {
  const Cycle blocked = egress_.blocked_from();
  const TileState state = classify(blocked <= now);
  ledger_.enter(state, now);
  const bool link_is_next = state != TileState::kLink && blocked != kNever && classify(true) == TileState::kLink;
  due_.link_state = link_is_next ? blocked : kNever;
}

/// Before anything changes at `now`.
void Tile::note_blocked(Cycle now) {
  if (due_.link_state < now) ledger_.enter(TileState::kLink, due_.link_state);
}

}  // namespace carousel::ringbus::cycle
