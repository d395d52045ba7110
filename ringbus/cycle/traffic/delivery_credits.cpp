#include "ringbus/cycle/traffic/delivery_credits.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

Cycle DeliveryCredits::next() const {
  Cycle first = kNever;
  for (const Channel<TrafficAck>* acks : in_) first = std::min(first, acks->next());
  return first;
}

void DeliveryCredits::take(Cycle end) {
  for (std::size_t a = 0; a < in_.size(); ++a) {
    Channel<TrafficAck>& acks = *in_[a];
    for (Cycle at; (at = acks.next()) < end;) {
      const TrafficAck ack = acks.take();
      if (ack.source == id_.value)
        allowances_[ack.direction].acks.push_back(at);
      else
        passing_[a].push_back({at, ack});
    }
  }
}

void DeliveryCredits::forward(std::size_t a, Cycle end) {
  Fifo<PassingAck>& passing = passing_[a];
  for (; !passing.empty() && passing.front().at < end; passing.pop_front())
    out_[a]->send(passing.front().at + latency_, passing.front().ack);
}

void DeliveryCredits::acknowledge(const TrafficToken& token, std::size_t direction, Cycle now) {
  const std::size_t a = topology_.ack_direction(direction);
  forward(a, now + 1);  // earlier acknowledgements leave earlier
  out_[a]->send(now + latency_, {token.source, static_cast<std::uint16_t>(direction)});
}

bool DeliveryCredits::use(std::size_t direction, Cycle now) {
  Allowance& allowance = allowances_[direction];
  for (; !allowance.acks.empty() && allowance.acks.front() <= now; allowance.acks.pop_front()) ++allowance.left;
  if (allowance.left == 0) return false;
  --allowance.left;
  return true;
}

}  // namespace carousel::ringbus::cycle
