#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/statistics/byte_row.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus {

class Agent;
class ChannelList;
class WakeupTable;

/// A kind of message of a machine: a row of its byte ledger.
enum class MessageKind : std::uint32_t {};

/// The ends of a channel.
struct ChannelEnds {
  std::uint32_t from = 0, to = 0;  ///< the machine's numbers of the two agents
  Cycle latency = 1;               ///< the least time from sending to arrival, and until a place is given back
  bool notifies = false;           ///< the receiver hears of arrivals by Agent::notify()
};

/// The place of a channel in the list of its machine.
struct ChannelPlace {
  ChannelList& list;
  MessageKind kind;
  ChannelEnds ends;
};

/// A channel, whatever it carries.
class AnyChannel {
 public:
  virtual ~AnyChannel() = default;
  AnyChannel(const AnyChannel&) = delete;
  AnyChannel& operator=(const AnyChannel&) = delete;

  /// In all, as the sender and the receiver have counted; while no agent runs. `waiting` are those that have been sent
  /// and not taken.
  struct Count {
    std::uint64_t sent = 0, taken = 0, waiting = 0;
  };
  virtual Count messages() const = 0;
  /// Of a channel whose messages say their size.
  virtual Count bytes() const = 0;
  virtual std::uint64_t bytes_sent() const = 0;  ///< for the sender, or while no agent runs
  /// From now on `slot` keeps the earliest arrival that was sent since it was last cleared. The sender writes it.
  virtual void wakes(Cycle& slot) = 0;

 protected:
  AnyChannel() = default;
};

/// Every channel of a machine. A channel cannot be made without a place in such a list, and the bytes, the length of
/// the windows and the announcements of arrivals come from the list; so no channel is free, and none is forgotten.
class ChannelList {
 public:
  /// Adds a row to the byte ledger, whose counts are zero. `bytes_each`: size of a message whose type does not say it.
  MessageKind carry(const ByteRow& row, std::uint64_t bytes_each = 0);
  /// For a width that is known only when the parts have been made.
  void set_width(MessageKind kind, std::uint64_t bytes_per_cycle) { kinds_[index(kind)].row.width = bytes_per_cycle; }
  ChannelPlace at(MessageKind kind, const ChannelEnds& ends) { return {*this, kind, ends}; }

  /// For Channel, which outlives the list's use. `sized`: its messages say their size. Throws a std::logic_error if
  /// nothing says it, or if the latency is zero.
  void add(AnyChannel& channel, MessageKind kind, const ChannelEnds& ends, bool sized);

  std::size_t size() const { return channels_.size(); }
  /// The least latency of any channel; kNever when there are none.
  Cycle least_latency() const;
  /// Connects every channel. `agents` by number.
  void connect(WakeupTable& wakeups, std::span<const Agent* const> agents) const;
  /// The rows of the byte ledger in the order in which they were added, with the counts of all channels.
  std::vector<ByteRow> rows() const;
  /// ByteRow::bytes of each row, while no agent runs.
  void bytes_sent(std::vector<std::uint64_t>& bytes) const;
  static std::size_t index(MessageKind kind) { return static_cast<std::size_t>(kind); }

 private:
  struct Kind {
    ByteRow row;
    std::uint64_t bytes_each = 0;
  };
  struct Listed {
    AnyChannel* channel;
    MessageKind kind;
    ChannelEnds ends;
    bool sized;
  };
  std::vector<Kind> kinds_;
  std::vector<Listed> channels_;
};

}  // namespace carousel::ringbus
