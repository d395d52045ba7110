// Every channel of a machine is in its list, from which the ledger of bytes, the length of the windows and the
// announcements of arrivals come.
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/time/channel.h"
#include "ringbus/time/windows.h"

namespace carousel::ringbus {
namespace {

struct Sized {
  std::uint64_t size = 0;
  std::uint64_t bytes() const { return size; }
};

/// Sends the numbers that come on a channel on to others, until ten have come.
class Relay final : public Agent {
 public:
  explicit Relay(Channel<int>& in) : in_(in) {}
  void sends(Channel<int>& out, Cycle latency) { out_.push_back({&out, latency}); }
  void starts() { starts_ = true; }

  Cycle next() const override { return starts_ ? 1 : in_.next(); }
  bool polled() const override { return false; }
  void notify(Cycle at) override { noted_.push_back(at); }
  void run(Cycle end) override {
    for (Cycle now; (now = next()) < end;) {
      const int value = starts_ ? 0 : in_.take() + 1;
      starts_ = false;
      heard_.push_back(now);
      for (const Out& out : out_)
        if (value < 10) out.channel->send(now + out.latency, value);
    }
  }
  std::string describe() const override { return ""; }
  const std::vector<Cycle>& heard() const { return heard_; }
  const std::vector<Cycle>& noted() const { return noted_; }

 private:
  struct Out {
    Channel<int>* channel;
    Cycle latency;
  };
  Channel<int>& in_;
  std::vector<Out> out_;
  bool starts_ = false;
  std::vector<Cycle> heard_, noted_;
};

TEST(ChannelList, CountsMessagesThatSayTheirSizeAndThoseOfOneSize) {
  ChannelList list;
  const MessageKind sized = list.carry({"sized", "a", "b", "wires", 4}),
                    equal = list.carry({"equal", "b", "a", "others", 8}, 12);
  Channel<Sized> first(list.at(sized, {0, 1, 3})), second(list.at(sized, {1, 0, 5}));
  Channel<int> third(list.at(equal, {0, 1, 4}));
  first.send(3, {100});
  first.send(4, {10});
  second.send(5, {1});
  third.send(4, 0);
  third.send(4, 0);
  first.take();
  third.take();
  const std::vector<ByteRow> rows = list.rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].what, "sized");
  EXPECT_EQ(rows[0].width, 4u);
  EXPECT_EQ(rows[0].bytes, 111u);
  EXPECT_EQ(rows[0].bytes_taken, 100u);
  EXPECT_EQ(rows[0].bytes_waiting, 11u);
  EXPECT_EQ(rows[0].messages, 3u);
  EXPECT_EQ(rows[1].bytes, 24u);
  EXPECT_EQ(rows[1].bytes_taken, 12u);
  EXPECT_EQ(rows[1].bytes_waiting, 12u);
  EXPECT_EQ(rows[1].messages, 2u);
}

TEST(ChannelList, ThereIsNoChannelWithoutSizeOrLatency) {
  ChannelList list;
  const MessageKind kind = list.carry({"nothing", "a", "b", "wires", 4});
  EXPECT_THROW(Channel<int>(list.at(kind, {})), std::logic_error);
  EXPECT_THROW(Channel<Sized>(list.at(kind, {0, 1, 0})), std::logic_error);
  EXPECT_EQ(list.size(), 0u);
  EXPECT_EQ(list.least_latency(), kNever);
}

/// A small machine: two relays that send to each other.
struct TwoRelays {
  ChannelList list;
  MessageKind kind = list.carry({"numbers", "relays", "relays", "wires", 4}, 4);
  Channel<int> there{list.at(kind, {0, 1, 3})}, back{list.at(kind, {1, 0, 7})};
  Relay a{back}, b{there};

  TwoRelays() {
    a.sends(there, 3);
    b.sends(back, 7);
    a.starts();
  }
  /// `more`: further relays.
  void run(const std::vector<Relay*>& more = {}) {
    std::vector<std::vector<Agent*>> parts{{&a}, {&b}};
    for (Relay* one : more) parts.back().push_back(one);
    std::vector<const Agent*> agents{&a, &b};
    for (Relay* one : more) agents.push_back(one);
    WakeupTable wakeups(parts);
    list.connect(wakeups, agents);
    run_windows(parts, wakeups, list.least_latency(), Sharing::kAlways, [](Cycle) { return true; });
  }
};

TEST(ChannelList, AChannelMoreIsInTheLedgerInTheWindowsAndInTheAnnouncements) {
  TwoRelays two;
  EXPECT_EQ(two.list.least_latency(), 3u);
  two.run();
  ASSERT_EQ(two.list.rows().size(), 1u);
  EXPECT_EQ(two.list.rows()[0].bytes, 4 * 10u);

  // The second relay also sends what it hears to a third one, over a shorter wire.
  TwoRelays more;
  const MessageKind copies = more.list.carry({"copies", "relays", "listeners", "wires of copies", 2}, 6);
  Channel<int> copy(more.list.at(copies, {1, 2, 2, true}));
  Relay third(copy);
  more.b.sends(copy, 2);
  EXPECT_EQ(more.list.least_latency(), 2u);
  more.run({&third});
  ASSERT_EQ(third.heard().size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(third.heard()[i], more.b.heard()[i] + 2);
  EXPECT_EQ(third.noted(), third.heard());  // it was told
  const std::vector<ByteRow> rows = more.list.rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].bytes, 4 * 10u);
  EXPECT_EQ(rows[1].what, "copies");
  EXPECT_EQ(rows[1].bytes, 6 * 5u);
  EXPECT_EQ(rows[1].bytes_taken, 6 * 5u);
}

}  // namespace
}  // namespace carousel::ringbus
