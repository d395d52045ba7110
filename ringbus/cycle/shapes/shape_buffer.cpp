#include "ringbus/cycle/shapes/shape_buffer.h"

#include <algorithm>
#include <span>

#include "core/system/error.h"

namespace carousel::ringbus::cycle {

ShapeBuffer::ShapeBuffer(const MemoryConfig& config, const LinkConfig& link, const SidePorts& ports)
    : port_(config, link, ports),
      pushed_(ports.pushed),
      drops_(config.shape_stay == MemoryConfig::ShapeStay::kWhileUsed),
      places_(static_cast<std::uint64_t>(config.shape_buffer_kib) * 1024 / kPlaceBytes),
      free_places_(places_),
      buckets_(64, kNone),
      shift_(64 - 6) {}

// ---- users

bool ShapeBuffer::take(User user, const ShapeNeed& need, Cycle now) {
  UserState& state = state_of(user);
  if (need.size() == 1 && need.shapes.bytes > 0) [[likely]]
    if (const std::uint32_t index = find(need.shapes); index != kNone) {  // as grant() does, in less time
      const Entry& entry = entries_[index];
      state.state = State::kHolds;
      state.missing = 0;
      state.complete_at = now;
      state.spans = 1;
      state.near[0].entry = index;
      hold(index);
      count_read(need.shapes.row, false);
      ++(entry.here ? counts_.hits : counts_.merged);
      if (!entry.here) wait_for(index, user, 0);
      return state.missing == 0;
    }
  if (grant(user, need, true, now)) return state.missing == 0;
  ++counts_.room_waits;
  state.state = State::kWaits;
  requests_[user].need = need;
  room_.push_back(user);
  return false;
}

void ShapeBuffer::release(User user, Cycle now) {
  if (user >= users_.size()) return;
  UserState& state = users_[user];
  if (state.state == State::kWaits) {
    room_.erase(std::find(room_.begin(), room_.end(), user));
    state.state = State::kNothing;
  } else if (state.state == State::kHolds) {
    drop(state, user);
  }
  if (!room_.empty() || granted_ < queue_.size()) serve(now);
}

void ShapeBuffer::hand_over(User from, User to) {
  UserState& receiver = state_of(to);
  UserState& giver = users_[from];
  receiver.state = State::kHolds;
  receiver.missing = 0;
  receiver.near = giver.near;
  receiver.spans = giver.spans;
  if (giver.spans > kNear) {
    grow_to(far_, to + std::size_t{1});
    far_[to] = far_[from];
  }
  giver.state = State::kNothing;
}

/// Gives up all that a user holds.
void ShapeBuffer::drop(UserState& state, User user) {
  for (std::uint32_t which = 0; which < state.spans; ++which) {
    const std::uint32_t entry = hold_of(user, which).entry;
    if (entry == kNone) continue;
    if (!entries_[entry].here) stop_waiting(entry, wait_of(user, which));
    let_go(entry);
  }
  state.state = State::kNothing;
}

// ---- the issue queue

void ShapeBuffer::take_ahead(User user, const ShapeNeed& need, Cycle now, std::uint64_t others) {
  UserState& state = state_of(user);
  state.state = State::kWaits;
  state.ahead = true;
  requests_[user] = {need, others};
  queue_.push_back(user);
  serve(now);
}

void ShapeBuffer::leave_queue(User user) {
  queue_.pop_front();
  --granted_;
  users_[user].ahead = false;
}

void ShapeBuffer::clear_queue(Cycle now) {
  for (const User user : queue_) {
    UserState& state = users_[user];
    if (state.state == State::kHolds) drop(state, user);
    state.state = State::kNothing;
    state.ahead = false;
  }
  queue_.clear();
  granted_ = 0;
  serve(now);
}

// ---- room

/// Gives `user` the places for all that it needs, if there are enough, and asks for what is not there. A test goes
/// before the packets of the issue queue, which give up their places for it.
bool ShapeBuffer::grant(User user, const ShapeNeed& need, bool test, Cycle now) {
  const std::size_t spans = need.size();
  std::array<std::uint32_t, ShapeNeed::kMost> found;
  std::fill(found.begin(), found.begin() + spans, kNone);
  std::uint64_t wanted = 0;
  const auto look = [&] {
    wanted = 0;
    for (std::size_t which = 0; which < spans; ++which) {
      if (need[which].bytes == 0) continue;
      found[which] = find(need[which]);
      if (found[which] == kNone) wanted += places_to_ask(need[which]);
    }
  };
  look();
  if (wanted > 0) {
    if (test && !room_.empty() && room_.front() != user) return false;
    if (!test && !room_.empty()) return false;
    const auto room = [&] {
      std::uint64_t own = 0;  // places of shapes that the user itself needs cannot make room
      for (const std::uint32_t entry : std::span(found).first(spans))
        if (entry != kNone && entries_[entry].here && entries_[entry].holders == 0) own += entries_[entry].places;
      return free_places_ + idle_places_ - own;
    };
    while (room() < wanted) {
      std::uint64_t all = 0;
      for (std::size_t which = 0; which < spans; ++which) all += places_to_ask(need[which]);
      if (all > places_) throw SimulationError("a strip with its records is larger than the shape buffer");
      if (!test || granted_ == 0) return false;
      const User last = queue_[--granted_];
      UserState& state = users_[last];
      drop(state, last);
      state.state = State::kWaits;
      queue_changed_ = true;
      if (drops_) look();  // it may have been the only one to hold what is needed
    }
  }
  UserState& state = users_[user];
  state.state = State::kHolds;
  state.missing = 0;
  state.complete_at = now;
  state.spans = static_cast<std::uint8_t>(spans);
  if (spans > kNear) grow_to(far_, user + std::size_t{1});
  for (const std::uint32_t entry : std::span(found).first(spans))
    if (entry != kNone) hold(entry);
  for (std::size_t which = 0; which < spans; ++which) {
    std::uint32_t& entry = hold_of(user, which).entry = found[which];
    if (need[which].bytes == 0) continue;
    count_read(need[which].row, entry == kNone);
    if (entry == kNone) {
      while (free_places_ < places_to_ask(need[which])) evict_oldest();
      entry = allocate(need[which], places_to_ask(need[which]));
      hold(entry);
      port_.request(need[which], entry, now, state.ahead ? requests_[user].others : 0);
      ++fetches_;
      ++counts_.misses;
    } else {
      ++(entries_[entry].here ? counts_.hits : counts_.merged);
    }
    if (!entries_[entry].here) wait_for(entry, user, which);
  }
  return true;
}

/// Gives room to those who wait for it: tests first, then the issue queue.
void ShapeBuffer::serve(Cycle now) {
  while (!room_.empty()) {
    const User user = room_.front();
    const ShapeNeed& need = requests_[user].need;
    if (!grant(user, need, true, now)) return;
    room_.pop_front();
    if (users_[user].missing == 0) ready_.push_back(user);
  }
  for (; granted_ < queue_.size(); ++granted_) {
    const User user = queue_[granted_];
    const ShapeNeed& need = requests_[user].need;
    if (!grant(user, need, false, now)) return;
    queue_changed_ = true;
  }
}

// ---- fetches

void ShapeBuffer::wait_for(std::uint32_t index, User user, std::size_t which) {
  const std::uint32_t wait = wait_of(user, which);
  Entry& entry = entries_[index];
  next_wait(wait) = kNone;
  if (entry.first_wait == kNone)
    entry.first_wait = wait;
  else
    next_wait(entry.last_wait) = wait;
  entry.last_wait = wait;
  ++users_[user].missing;
}

/// Takes one wait from the middle of an entry's list.
void ShapeBuffer::stop_waiting(std::uint32_t index, std::uint32_t wait) {
  Entry& entry = entries_[index];
  std::uint32_t before = kNone;
  for (std::uint32_t at = entry.first_wait; at != wait; at = next_wait(at)) before = at;
  (before == kNone ? entry.first_wait : next_wait(before)) = next_wait(wait);
  if (entry.last_wait == wait) entry.last_wait = before;
}

void ShapeBuffer::take_answers(Cycle now) {
  bool room = false;  // there is more
  while (port_.next() <= now) {
    const std::uint32_t tag = port_.take();
    if ((tag & kSpillTag) != 0) [[unlikely]] {
      spill_answers_.push_back(tag & ~kSpillTag);
      continue;
    }
    Entry& entry = entries_[tag];
    --fetches_;
    entry.here = true;
    if (const std::uint64_t spare = entry.places - places(entry.span); spare > 0) [[unlikely]] {
      entry.places -= spare;
      free_places_ += spare;
      room = true;
    }
    for (std::uint32_t wait = entry.first_wait; wait != kNone; wait = next_wait(wait)) {
      UserState& state = users_[user_of(wait)];
      if (--state.missing > 0) continue;
      state.complete_at = now;
      if (state.ahead)
        queue_changed_ = true;
      else
        ready_.push_back(user_of(wait));
    }
    entry.first_wait = entry.last_wait = kNone;
    if (entry.holders > 0) continue;
    // The users that asked for it have given it up meanwhile.
    ++entry.holders;
    let_go(static_cast<std::uint32_t>(&entry - entries_.data()));
    room = true;
  }
  if (pushed_ != nullptr) [[unlikely]]
    take_pushed(now);
  if (room) serve(now);
}

}  // namespace carousel::ringbus::cycle
