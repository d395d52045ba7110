#include "ringbus/cycle/traffic/channel_claims.h"

namespace carousel::ringbus::cycle {

namespace {

/// Places from the one that goes first to `at`, of `many` that have turns.
std::size_t turns_until(std::size_t at, std::size_t first, std::size_t many) {
  return at >= first ? at - first : at + many - first;
}

}  // namespace

bool ChannelClaims::any_free(std::size_t begin, std::size_t end) const {
  for (std::size_t channel = begin; channel < end; ++channel)
    if (!taken_[channel]) return true;
  return false;
}

void ChannelClaims::offer() {
  for (const Asking& one : asking_)
    for (std::size_t channel = one.begin; channel < one.end; ++channel) offers_[channel] = kNone;
  for (const Asking& one : asking_)
    for (std::size_t channel = one.begin; channel < one.end; ++channel) {
      if (taken_[channel]) continue;
      std::size_t& best = offers_[channel];
      const std::size_t first = next_queue_[channel], many = of_.size();
      if (best == kNone || turns_until(one.queue, first, many) < turns_until(best, first, many)) best = one.queue;
    }
}

bool ChannelClaims::accept(const Asking& one) {
  std::size_t best = kNone;
  const std::size_t first = next_channel_[one.queue], many = taken_.size();
  for (std::size_t channel = one.begin; channel < one.end; ++channel)
    if (offers_[channel] == one.queue &&
        (best == kNone || turns_until(channel, first, many) < turns_until(best, first, many)))
      best = channel;
  if (best == kNone) return false;
  take(one.queue, best);
  next_channel_[one.queue] = best + 1 < many ? best + 1 : 0;
  next_queue_[best] = one.queue + 1 < of_.size() ? one.queue + 1 : 0;
  return true;
}

}  // namespace carousel::ringbus::cycle
