#pragma once

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "ringbus/stress/delivery_checker.h"
#include "ringbus/stress/queue_under_test.h"

namespace carousel::ringbus::stress {

/// Checks an empty queue from one thread, over several rounds of its storage: it must take exactly as many messages as
/// its capacity, refuse more, give all back in order, and never promise places that it does not have.
template <std::size_t kBytes>
Violations check_single_thread(AnyQueue<Message<kBytes>>& queue, std::size_t capacity) {
  constexpr std::size_t kRounds = 4;
  Violations out;
  const auto wrong = [&](std::string what) {
    ++out.bounds;
    if (out.detail.empty()) out.detail = std::move(what);
  };
  if (queue.capacity() != capacity)
    wrong(fmt::format("made for {} messages it says it holds {}", capacity, queue.capacity()));
  DeliveryChecker arrivals(1, kRounds * (10 * capacity + 128));  // more than is pushed below
  std::uint64_t sent = 0, inside = 0;
  std::array<Message<kBytes>, 7> batch;
  const auto push = [&](std::size_t want) {
    const std::size_t room = capacity - std::min<std::size_t>(inside, capacity);
    const std::size_t promised = queue.free_places();
    if (promised > room) wrong(fmt::format("{} places promised with {} of {} taken", promised, inside, capacity));
    for (std::size_t i = 0; i < want; ++i) batch[i] = Message<kBytes>::of({0, static_cast<std::uint32_t>(sent + i)});
    const std::size_t got = want == 1 ? queue.try_push(batch[0]) : queue.try_push_n(std::span(batch).first(want));
    if (got > room) wrong(fmt::format("a push was taken with {} of {} places taken", inside, capacity));
    if (got == 0 && room > 0) wrong(fmt::format("a push was refused with {} of {} places taken", inside, capacity));
    sent += got;
    inside += got;
    return got;
  };
  const auto pop = [&](std::size_t want) {
    const std::size_t got = want == 1 ? queue.try_pop(batch[0]) : queue.try_pop_n(std::span(batch).first(want));
    for (std::size_t i = 0; i < got; ++i) (void)arrivals.take(batch[i]);
    inside -= std::min<std::uint64_t>(got, inside);
    return got;
  };
  for (std::size_t round = 0; round < kRounds && out.bounds == 0; ++round) {
    while (inside < capacity && push(1) > 0) {
    }
    (void)push(1);  // refused
    (void)push(3);
    while (pop(1) > 0) {
    }
    inside = 0;  // messages that are still missing are lost
    for (std::size_t i = 0; i < capacity + 8; ++i) {
      (void)push(1 + i % 7);
      (void)pop(1 + (i * 3) % 7);
    }
    while (pop(7) > 0) {
    }
    inside = 0;
    for (std::size_t i = 0; i < capacity + 3 && out.bounds == 0; ++i) {
      (void)push(1);
      (void)pop(1);
    }
  }
  const std::array<DeliveryChecker, 1> all{std::move(arrivals)};
  const std::array<std::uint64_t, 1> pushed{sent};
  out += DeliveryChecker::judge(all, pushed);
  return out;
}

}  // namespace carousel::ringbus::stress
