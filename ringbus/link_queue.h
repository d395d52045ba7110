#pragma once

#include <concepts>
#include <cstddef>
#include <span>

namespace carousel::ringbus {

/// How many threads may push, or pop, at the same time.
enum class Parties { kOne, kMany };

/// A bounded first-in first-out queue that a link can be made of. No call blocks: a refusal means full (push)
/// or empty (pop) at some moment during the call and changes nothing. Batch calls take a prefix: they return
/// how many moved. `free_places` may be called by a producer and is a lower bound until it pushes itself, as
/// long as it is the only one. A pop happens after the push of the same value, with all the pusher wrote before.
template <class Q, class T>
concept LinkQueue = requires(Q q, const T& in, T& out, std::span<const T> many_in, std::span<T> many_out) {
  { Q::kProducers } -> std::convertible_to<Parties>;
  { Q::kConsumers } -> std::convertible_to<Parties>;
  { q.try_push(in) } -> std::same_as<bool>;
  { q.try_pop(out) } -> std::same_as<bool>;
  { q.try_push_n(many_in) } -> std::same_as<std::size_t>;
  { q.try_pop_n(many_out) } -> std::same_as<std::size_t>;
  { q.free_places() } -> std::same_as<std::size_t>;
  { q.capacity() } -> std::same_as<std::size_t>;
};

/// Batch calls in terms of single ones, for queues that have nothing better.
template <class Q, class T>
std::size_t push_one_by_one(Q& queue, std::span<const T> values) {
  std::size_t pushed = 0;
  while (pushed < values.size() && queue.try_push(values[pushed])) ++pushed;
  return pushed;
}
template <class Q, class T>
std::size_t pop_one_by_one(Q& queue, std::span<T> values) {
  std::size_t popped = 0;
  while (popped < values.size() && queue.try_pop(values[popped])) ++popped;
  return popped;
}

}  // namespace carousel::ringbus
