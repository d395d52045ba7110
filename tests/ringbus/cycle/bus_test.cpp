// A bus all resources hear (issue 16, defect 14): what one sends crosses the medium once, to the cycle.
#include "ringbus/cycle/fabric/bus.h"

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

/// Four resources on a bus with two places at the end of each link. A hop of 9 cycles: 4 to the bus and 5 from it.
class FourOnABus {
 public:
  explicit FourOnABus(const std::string& visit)
      : topology_(load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\n"
                               "topology: {shape: bus, resources: 4, visit: " +
                                   visit + ", link: {latency_cycles: 9, depth: 2}}\n",
                               "bus.yaml"})
                      .config.topology) {
    std::vector<InPort> to_bus;
    std::vector<OutPort> from_bus;
    for (std::size_t r = 0; r < 4; ++r) {
      out.emplace_back(up_[r], 4, 2, 100);
      to_bus.push_back({&up_[r], 4});
      from_bus.emplace_back(down_[r], 5, 2, 100);
      in.push_back({&down_[r], 5});
    }
    packets_.resize(3);
    bus = std::make_unique<Bus>(topology_, packets_, std::move(to_bus), std::move(from_bus));
  }
  /// Packet `number` has rays of the resources whose bits are set.
  void packet(std::uint32_t number, std::uint32_t owner, std::uint64_t rays_of) {
    packets_[number].owner = packets_[number].home = ResourceId(owner);
    packets_[number].owners = {rays_of};
  }
  void send(std::uint32_t from, std::uint32_t number, std::uint16_t cycles, Cycle now, bool answers = false) {
    Token token{.packet = PacketId(number), .rays = 7, .link_cycles = cycles};
    token.answers = answers;
    out[from].push(token, now, false);
    ASSERT_TRUE(out[from].send(now));
  }
  void run() { bus->run(1000); }

  std::vector<OutPort> out;
  std::vector<InPort> in;
  std::unique_ptr<Bus> bus;

 private:
  Topology topology_;
  std::vector<Packet> packets_;
  std::array<LooseWire, 4> up_, down_;
};

TEST(BusBroadcast, OneCrossingReachesAllWhoHaveRaysOfThePacket) {
  FourOnABus four("owners");
  four.packet(0, 0, 0b1011);  // rays of 0, 1 and 3
  four.packet(1, 2, 0b0110);  // rays of 1 and 2
  four.send(0, 0, 5, 10);     // its tail is at the bus in 10 + 4 + 5 - 1 = 18
  four.send(2, 1, 3, 10);     // in 10 + 4 + 3 - 1 = 16, and has the medium from 16 to 18
  four.run();
  // Packet 0 has the medium from 19 to 23; its tail arrives in 19 + 5 + 5 - 1.
  EXPECT_EQ(four.in[1].next(), 16u + 5 + 3 - 1);
  EXPECT_EQ(four.in[1].take(23).packet, PacketId(1));
  EXPECT_EQ(four.in[1].next(), 28u);
  EXPECT_EQ(four.in[3].next(), 28u);
  EXPECT_EQ(four.in[0].next(), kNever);
  EXPECT_EQ(four.in[2].next(), kNever);
  const Token heard = four.in[3].take(28);
  EXPECT_EQ(heard.packet, PacketId(0));
  EXPECT_FALSE(heard.passes);
  // The answer goes to the owner alone.
  four.send(3, 0, 2, 40, true);  // at the bus in 45
  four.run();
  EXPECT_EQ(four.in[0].next(), 45u + 5 + 1);
  EXPECT_TRUE(four.in[0].take(51).answers);
  for (std::size_t other : {2u, 3u}) EXPECT_EQ(four.in[other].next(), kNever);
  EXPECT_EQ(four.bus->out()[1].packets(), 2u);
}

TEST(BusBroadcast, WithVisitAllTheOthersHearItToo) {
  FourOnABus four("all");
  four.packet(0, 0, 0b1000);
  four.send(0, 0, 1, 0);  // at the bus in 4
  four.run();
  for (std::size_t listener : {1u, 2u, 3u}) {
    EXPECT_EQ(four.in[listener].next(), 9u);
    EXPECT_EQ(four.in[listener].take(9).passes, listener != 3);
  }
  EXPECT_EQ(four.in[0].next(), kNever);
}

TEST(BusBroadcast, WaitsForAPlaceAtEveryListenerAndLetsOthersGo) {
  FourOnABus four("owners");
  four.packet(0, 0, 0b1010);  // rays of 1 and 3
  four.packet(1, 2, 0b0010);  // a ray of 1
  four.packet(2, 2, 0b1000);  // a ray of 3
  four.send(2, 1, 1, 0);
  four.send(0, 0, 1, 1);
  four.run();  // resource 1 has two packets now, and resource 3 one
  EXPECT_EQ(four.in[1].next(), 9u);
  EXPECT_EQ(four.in[3].next(), 10u);
  four.send(0, 0, 1, 20);  // at the bus in 24: resource 1 has no place
  four.send(2, 2, 1, 21);  // in 25: resource 3 has one
  four.run();
  EXPECT_EQ(four.in[3].take(30).packet, PacketId(0));
  EXPECT_EQ(four.in[3].next(), 30u);
  EXPECT_EQ(four.in[3].take(31).packet, PacketId(2));
  EXPECT_EQ(four.in[3].next(), kNever);
  four.in[1].take(50);  // the credit is at the bus in 55
  four.run();
  EXPECT_EQ(four.in[3].next(), 60u);
  four.in[1].take(61);
  EXPECT_EQ(four.in[1].next(), 60u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
