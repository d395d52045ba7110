#include "ringbus/time/channel_list.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "ringbus/time/wakeup_table.h"

namespace carousel::ringbus {

MessageKind ChannelList::carry(const ByteRow& row, std::uint64_t bytes_each) {
  kinds_.push_back({row, bytes_each});
  return static_cast<MessageKind>(kinds_.size() - 1);
}

void ChannelList::add(AnyChannel& channel, MessageKind kind, const ChannelEnds& ends, bool sized) {
  const Kind& of = kinds_.at(index(kind));
  if (!sized && of.bytes_each == 0)
    throw std::logic_error("nothing says how many bytes a message has: " + std::string(of.row.what));
  if (ends.latency == 0) throw std::logic_error("a channel without latency: " + std::string(of.row.what));
  channels_.push_back({&channel, kind, ends, sized});
}

Cycle ChannelList::least_latency() const {
  Cycle least = kNever;
  for (const Listed& one : channels_) least = std::min(least, one.ends.latency);
  return least;
}

void ChannelList::connect(WakeupTable& wakeups, std::span<const Agent* const> agents) const {
  for (const Listed& one : channels_) {
    const Agent &from = *agents[one.ends.from], &to = *agents[one.ends.to];
    if (one.ends.notifies)
      wakeups.connect_beside(*one.channel, from, to);
    else
      wakeups.connect(*one.channel, from, to);
  }
}

void ChannelList::bytes_sent(std::vector<std::uint64_t>& bytes) const {
  bytes.assign(kinds_.size(), 0);
  for (const Listed& one : channels_)
    bytes[index(one.kind)] +=
        one.sized ? one.channel->bytes_sent() : kinds_[index(one.kind)].bytes_each * one.channel->messages().sent;
}

std::vector<ByteRow> ChannelList::rows() const {
  std::vector<ByteRow> rows;
  for (const Kind& kind : kinds_) rows.push_back(kind.row);
  for (const Listed& one : channels_) {
    ByteRow& row = rows[index(one.kind)];
    const AnyChannel::Count messages = one.channel->messages();
    AnyChannel::Count bytes = one.channel->bytes();
    if (!one.sized) {
      const std::uint64_t each = kinds_[index(one.kind)].bytes_each;
      bytes = {each * messages.sent, each * messages.taken, each * messages.waiting};
    }
    row.bytes += bytes.sent;
    row.bytes_taken += bytes.taken;
    row.bytes_waiting += bytes.waiting;
    row.messages += messages.sent;
  }
  return rows;
}

}  // namespace carousel::ringbus
