#pragma once

#include <concepts>
#include <cstddef>
#include <span>

namespace carousel::ringbus {

/// How many threads may push, or pop, at the same time.
enum class Parties { kOne, kMany };

/// A bounded queue that a link can be made of; docs/guides/queues.md shows how to bring one's own.
///
/// Made from a capacity of at least 1; T is trivially copyable and default-constructible.
/// - Who may call: `try_push`, `try_push_n` and `free_places` the producers, `try_pop` and `try_pop_n` the consumers,
///   as many at a time as kProducers and kConsumers say; `capacity` anyone. Making and destroying: one thread alone.
/// - Refusal: no call waits for another thread to do something. A push is refused when `capacity` values were inside
///   at some moment during the call, a pop when none was; where several threads push (pop), one whose call is not
///   over counts as inside (as not inside). A refusal changes nothing, and the caller yields before it insists.
/// - Batches move a prefix and return its length, which may be less than there was room or values for, but is never
///   0 where a single call would have succeeded.
/// - `free_places` is a lower bound: a producer that is the only one may push so many without being refused.
/// - Order: the values of one producer are popped in the order in which it pushed them, as far as one consumer can
///   tell. Each value is popped once.
/// - Memory: a pop happens after the push of the same value, with all that the pusher wrote before.
template <class Q, class T>
concept LinkQueue = std::constructible_from<Q, std::size_t> &&
    requires(Q q, const T& in, T& out, std::span<const T> many_in, std::span<T> many_out) {
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
