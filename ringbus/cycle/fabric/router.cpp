#include "ringbus/cycle/fabric/router.h"

#include <algorithm>

#include <fmt/format.h>

#include "ringbus/cycle/fabric/course.h"

namespace carousel::ringbus::cycle {

Cycle Router::next() const {
  // A packet that has not been taken in waits for one that leaves.
  Cycle first = kNever;
  for (const InPort& in : in_)
    if (const Cycle at = in.next(); at > now_) first = std::min(first, at);
  for (const OutPort& out : out_)
    if (const Cycle at = out.next(false); at > now_) first = std::min(first, at);
  return first;
}

void Router::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void Router::step(Cycle now) {
  look_at(now);
  now_ = now;
  for (OutPort& out : out_) out.take_credits(now);
  bool waits = take_in(now), room = true;
  while (room) {
    room = false;
    for (OutPort& out : out_) room |= out.send(now);
    room = room && waits;
    if (room) waits = take_in(now);
  }
  if (waits) turn_ = turn_ + 1 < in_.size() ? turn_ + 1 : 0;  // the next time, another link is the first
}

/// Takes in all packets that find a place. Returns whether any waits for one.
bool Router::take_in(Cycle now) {
  bool waits = false;
  for (std::size_t i = 0; i < in_.size(); ++i) {
    InPort& in = in_[(turn_ + i) % in_.size()];
    while (in.next() <= now) {
      Token token = in.front();
      const Course course = course_of(token, topology_, node_);
      OutPort& out = out_[course.port];
      if (!out.has_place()) {
        waits = true;
        break;
      }
      in.take(now);
      out.push(token, now, course.through);
    }
  }
  return waits;
}

std::string Router::describe() const {
  std::size_t egress = 0, waiting = 0;
  for (const OutPort& out : out_) egress += out.egress();
  for (const InPort& in : in_) waiting += in.next() != kNever;
  if (egress + waiting == 0) return "";
  return fmt::format("router {}: {} packets wait to leave, and the ends of {} links are full",
                     node_.value - topology_.resources(), egress, waiting);
}

}  // namespace carousel::ringbus::cycle
