// Links that fail, and what makes them good again.
#include "ringbus/native/links/reliable_link.h"

#include <array>
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "ringbus/faults/link_fault_timer.h"
#include "ringbus/faults/outstanding_rays.h"
#include "ringbus/queues/queue_types.h"
#include "tests/ringbus/queues/queue_kinds.h"

namespace carousel::ringbus {
namespace {

Config faulty(double drop, double duplicate, double corrupt, double reorder, double delay) {
  Config config;
  config.faults.links = {drop, duplicate, corrupt, reorder, delay, 20'000};
  config.topology.link.depth = 8;
  return config;
}

/// Sends 0, 1, 2 ... between two threads; how many came, and whether in order.
struct Delivered {
  std::uint32_t count = 0;
  bool in_order = true;
  LinkFaultCounts faults;
};
Delivered deliver(const Config& config, std::uint32_t packets) {
  const std::unique_ptr<Link> link = make_link(config, 3, ResourceId(0), ResourceId(1));
  Delivered out;
  std::atomic<bool> done{false};
  {
    std::jthread receiver([&] {
      std::array<PacketId, 4> got;
      while (out.count < packets) {
        const std::size_t n = link->try_receive(got);
        for (std::size_t i = 0; i < n; ++i) out.in_order &= got[i].value == out.count++;
        if (n == 0) std::this_thread::yield();
      }
      done = true;
    });
    for (std::uint32_t sent = 0; !done;) {
      std::array<PacketId, 5> batch;
      const std::size_t want = std::min<std::size_t>(batch.size(), packets - sent);
      for (std::size_t i = 0; i < want; ++i) batch[i] = PacketId(sent + static_cast<std::uint32_t>(i));
      const std::size_t took = link->try_send({batch.data(), want});
      EXPECT_LE(link->capacity() - link->free_places(), link->capacity());
      sent += static_cast<std::uint32_t>(took);
      (void)link->tick();
      if (took == 0) std::this_thread::yield();
    }
  }
  out.faults = link->faults();
  return out;
}

TEST(ReliableLink, EveryFaultIsMadeGood) {
  for (const QueueKind kind : queue_kinds())
    for (const Config& base : {faulty(0.1, 0.1, 0.1, 0.1, 0.1), faulty(0.2, 0, 0, 0, 0), faulty(0, 0.3, 0, 0, 0),
                               faulty(0, 0, 0.2, 0, 0), faulty(0, 0, 0, 0.3, 0), faulty(0, 0, 0, 0, 0.2)}) {
      // Each kind of queue with all faults, one with each.
      const bool all = base.faults.links.drop > 0 && base.faults.links.delay > 0;
      if (!all && kind != QueueKind::kSpscRing) continue;
      Config config = base;
      config.topology.link.queue = kind;
      const Delivered got = deliver(config, 200);
      EXPECT_EQ(got.count, 200u);
      EXPECT_TRUE(got.in_order);
      const FaultsConfig::Links& f = config.faults.links;
      EXPECT_EQ(got.faults.dropped > 0 && f.drop > 0, f.drop > 0);
      EXPECT_EQ(got.faults.duplicated > 0, f.duplicate > 0);
      EXPECT_EQ(got.faults.corrupted > 0, f.corrupt > 0);
      EXPECT_EQ(got.faults.reordered > 0, f.reorder > 0);
      EXPECT_EQ(got.faults.delayed > 0, f.delay > 0);
      if (f.drop > 0) {
        EXPECT_GT(got.faults.resent, 0u);
      }
      EXPECT_GT(got.faults.resent + got.faults.discarded, 0u);
    }
}

// Many frames of a deep link are lost at a time, and with a link of one place no later frame tells of a loss.
TEST(ReliableLink, DeliversThroughAnyDepth) {
  for (const std::int64_t depth : {1, 2, 3, 64, 1000}) {
    Config config = faulty(0.3, 0.2, 0.2, 0.3, 0.1);
    config.topology.link.depth = depth;
    const Delivered got = deliver(config, 300);
    EXPECT_EQ(got.count, 300u) << depth;
    EXPECT_TRUE(got.in_order) << depth;
  }
}

TEST(ReliableLink, HoldsNoMoreThanItsDepth) {
  const Config config = faulty(0, 0.5, 0, 0, 0);
  const std::unique_ptr<Link> link = make_link(config, 0, ResourceId(0), ResourceId(1));
  std::array<PacketId, 20> many;
  for (std::uint32_t i = 0; i < many.size(); ++i) many[i] = PacketId(i);
  EXPECT_EQ(link->capacity(), 8u);
  EXPECT_EQ(link->try_send(many), 8u);
  EXPECT_EQ(link->try_send(many), 0u);
  EXPECT_EQ(link->free_places(), 0u);
}

// A receiver that takes nothing must still say what it has: else places stay taken for ever, and a ring stops.
TEST(ReliableLink, PlacesComeBackThoughAcknowledgementsAreLost) {
  const Config config = faulty(0.6, 0, 0, 0, 0);
  const std::unique_ptr<Link> link = make_link(config, 1, ResourceId(0), ResourceId(1));
  std::array<PacketId, 8> many;
  EXPECT_EQ(link->try_send(many), 8u);
  std::size_t got = 0;
  const auto tick_until = [&](const auto& done) {
    for (int i = 0; i < 200'000 && !done(); ++i) {
      (void)link->tick();
      link->tick_receiver();
      if (i % 16 == 0) std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
  };
  tick_until([&] {
    got += link->try_receive(std::span(many).first(1));
    return got == 7;
  });
  EXPECT_EQ(got, 7u);
  tick_until([&] { return link->free_places() >= 7; });
  EXPECT_GE(link->free_places(), 7u);
}

/// Sends `packets` in turns of both ends; the receiver takes four every `pause` turns.
LinkFaultCounts send_in_turns(const Config& config, std::uint32_t packets, std::uint32_t pause) {
  const std::unique_ptr<Link> link = make_link(config, 1, ResourceId(0), ResourceId(1));
  std::array<PacketId, 4> got;
  std::uint32_t sent = 0, taken = 0;
  for (std::uint32_t turn = 0; taken < packets && turn < 100 * packets; ++turn) {
    (void)link->tick();
    for (PacketId next(sent); sent < packets && link->try_send({&next, 1}) == 1; next = PacketId(sent)) ++sent;
    link->tick_receiver();
    if (turn % pause != 0) continue;
    const std::size_t count = link->try_receive(got);
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(got[i].value, taken++);
  }
  EXPECT_EQ(taken, packets);
  return link->faults();
}

// A receiver that takes its packets one by one keeps the others, though they have left the wire.
TEST(ReliableLink, SendsNothingAgainThatWasNotLost) {
  for (const std::uint32_t pause : {1u, 2u, 3u}) {
    const LinkFaultCounts counts = send_in_turns(faulty(1e-12, 0, 0, 0, 0), 2000, pause);
    EXPECT_EQ(counts.dropped, 0u);
    EXPECT_EQ(counts.resent, 0u) << pause;
    EXPECT_EQ(counts.discarded, 0u) << pause;
  }
}

TEST(ReliableLink, ALossCostsOneFrame) {
  const LinkFaultCounts counts = send_in_turns(faulty(0.02, 0, 0, 0, 0), 5000, 1);
  EXPECT_GT(counts.dropped, 100u);
  EXPECT_GE(counts.resent, counts.dropped / 3);  // acknowledgements are lost as well, and need nothing sent again
  EXPECT_LE(counts.resent, counts.dropped);
  EXPECT_LE(counts.discarded, counts.dropped / 10);
}

Packet some_packet(std::uint32_t number) {
  const RayIdLayout layout(64);
  Packet p;
  p.kind = PacketKind::kTest;
  p.owner = ResourceId(number % 7);
  p.home = ResourceId(3);
  p.lanes = 1u << number % 8;
  p.depth = static_cast<std::uint16_t>(number);
  p.hops_left = 5 + number;
  p.reserved_blocks = 9;
  for (std::uint32_t i = 0; i < 1 + number % 5; ++i) {
    p.members.push_back({layout.make(ResourceId(i), number % 64), static_cast<std::uint8_t>(i + number)});
    p.next.push_back({accel::NodeKey{}, 0.5f * static_cast<float>(number), static_cast<std::uint16_t>(i), i % 2 == 0});
    p.addresses.push_back(ResourceId(i));
    p.requests.emplace_back().tag.path = number + i;
  }
  p.nearest[number % 8] = static_cast<float>(number);
  p.owners = {number, ~std::uint64_t{number}};
  return p;
}

TEST(PacketImage, HoldsAllOfAPacket) {
  const Packet packet = some_packet(8);
  Packet other = some_packet(3);
  restore(image_of(packet), other);
  EXPECT_EQ(other.owner, packet.owner);
  EXPECT_EQ(other.hops_left, packet.hops_left);
  EXPECT_EQ(other.reserved_blocks, packet.reserved_blocks);
  ASSERT_EQ(other.members.size(), packet.members.size());
  EXPECT_EQ(other.members[3].ray.bits, packet.members[3].ray.bits);
  EXPECT_EQ(other.members[3].mask, packet.members[3].mask);
  EXPECT_EQ(other.next[1].entry, packet.next[1].entry);
  EXPECT_EQ(other.requests[2].tag.path, packet.requests[2].tag.path);
  EXPECT_EQ(other.addresses, packet.addresses);
  EXPECT_EQ(other.nearest[0], packet.nearest[0]);
  EXPECT_EQ(other.owners, packet.owners);
}

// Packets arrive as they went over the wire, none of them damaged, though the memory that both ends share has been
// written over.
TEST(ReliableLink, CarriesCopiesAndNoDamagedOne) {
  const Config config = faulty(0, 0.1, 0.5, 0, 0);
  std::vector<Packet> packets(8);
  const std::unique_ptr<Link> link = make_link(config, 2, ResourceId(0), ResourceId(1), packets);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const PacketId id(i % 8);
    packets[id.value] = some_packet(i);
    const PacketImage sent = image_of(packets[id.value]);
    while (link->try_send({&id, 1}) == 0) {
      (void)link->tick();
      link->tick_receiver();
    }
    packets[id.value] = Packet{};
    PacketId got;
    for (int turn = 0; link->try_receive({&got, 1}) == 0; ++turn) {
      ASSERT_LT(turn, 10'000);
      (void)link->tick();
    }
    ASSERT_EQ(got, id);
    ASSERT_EQ(image_of(packets[id.value]), sent) << i;
  }
  EXPECT_GT(link->faults().corrupted, 100u);
  EXPECT_GT(link->faults().discarded, 100u);
}

TEST(RetransmitTimer, LearnsHowLongAnAnswerTakesAndDoublesInVain) {
  RetransmitTimer patience;
  RetransmitTimer::Clock::time_point time{};
  const auto now = [&] { return time; };
  const auto turns_until_it_ends = [&] {
    int turns = 1;
    while (!patience.ends(now)) ++turns;
    return turns;
  };
  const int first = turns_until_it_ends();
  EXPECT_EQ(turns_until_it_ends(), 2 * first);
  EXPECT_EQ(turns_until_it_ends(), 4 * first);
  // Answers that take 20 turns each are not taken for lost ones.
  std::uint64_t sequence = 0;
  for (int i = 0; i < 100; ++i) {
    patience.heard(sequence);
    patience.sent(sequence);
    for (int turn = 0; turn < 20; ++turn) (void)patience.ends(now);
    patience.heard(++sequence);
  }
  EXPECT_GT(turns_until_it_ends(), 20);
  // Turns that take a time slice each are few.
  int slow = 1;
  for (; !patience.ends(now); ++slow) time += std::chrono::milliseconds(3);
  EXPECT_EQ(slow, 2);
}

TEST(FaultInjector, TheSameSeedGivesTheSameFaults) {
  Config config = faulty(0.25, 0, 0.5, 0, 0);
  LinkFaultCounts a, b, other;
  const FaultsConfig& f = config.faults;
  FaultInjector first(f.links, f.seed, 5), again(f.links, f.seed, 5), stream(f.links, f.seed, 6);
  std::uint64_t drops = 0, same = 0;
  for (int i = 0; i < 4000; ++i) {
    const FaultDraw faults = first.next(a), twin = again.next(b), else_where = stream.next(other);
    EXPECT_EQ(faults.drop, twin.drop);
    EXPECT_EQ(faults.bits, twin.bits);
    drops += faults.drop;
    same += faults.bits == else_where.bits;
  }
  EXPECT_EQ(a, b);
  EXPECT_EQ(same, 0u);
  EXPECT_NEAR(static_cast<double>(drops), 1000, 150);
  EXPECT_NEAR(static_cast<double>(a.corrupted), 1500, 150);  // counted among frames that were not dropped
}

TEST(LinkFaultTimer, LosesTimeAndNothingElse) {
  Config config;
  config.faults.links.drop = 0.5;
  cycle::LinkFaultTimer timer(config.faults.links, config.faults.seed, 0, 10);
  Cycle now = 0, last = 0;
  std::uint64_t waited = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto delivery = timer.send(now, 2);
    // A try takes two cycles and 22 of patience; tries until one gets through.
    ASSERT_GE(delivery.arrival, now + 10);
    ASSERT_EQ((delivery.arrival - now - 10) % 24, 0u);
    ASSERT_EQ(delivery.link_free, delivery.arrival - 10 + 2);
    ASSERT_GE(delivery.arrival, last);
    waited += (delivery.arrival - now - 10) / 24;
    last = delivery.arrival;
    now = delivery.link_free;
  }
  EXPECT_EQ(timer.counts().resent, waited);
  EXPECT_EQ(timer.counts().dropped, waited);
  EXPECT_NEAR(static_cast<double>(waited), 2000, 250);  // a geometric distribution of mean 1
}

// Acknowledgements are lost, late and damaged; every place comes back once, and none before its time.
TEST(LinkFaultTimer, PlacesComeBackThoughAcknowledgementsFail) {
  Config config;
  config.faults.links = {0.3, 0.1, 0.2, 0.1, 0.2, 70};
  cycle::LinkFaultTimer timer(config.faults.links, config.faults.seed, 1, 10);
  std::uint64_t sent = 0, back = 0, late = 0;
  Cycle now = 0;
  for (int i = 0; i < 500; ++i) {
    const auto delivery = timer.send(now, 3);
    const Cycle at = std::max(delivery.arrival + 10, now);
    ++sent;
    back += timer.recovered(at).places;
    const std::uint32_t heard = timer.acknowledge(at);
    back += heard;
    late += heard == 0;
    ASSERT_LE(back, sent);
    EXPECT_EQ(heard > 0, back == sent);  // one that comes tells of all before it
    now = at + 1;
    // Now and then the sender has no more to send and waits for the rest.
    for (int wait = 0; i % 10 == 9 && back < sent; ++wait) {
      ASSERT_LT(wait, 1000);
      ASSERT_NE(timer.next(), kNever);
      ASSERT_GE(timer.next(), at);
      now = timer.next();
      back += timer.recovered(now).places;
    }
  }
  EXPECT_GT(late, 100u);
  EXPECT_GT(timer.counts().discarded, 0u);
}

TEST(OutstandingRays, HoldsWhatHasNotBeenShaded) {
  OutstandingRays ledger;
  RayBatch rays(3);
  for (std::uint32_t i = 0; i < 3; ++i) rays[i].tag.path = 2 - i;
  ledger.add(rays);
  HitBatch done(1);
  done[0].tag = rays[1].tag;
  ledger.remove(done);
  const RayBatch open = ledger.open();
  ASSERT_EQ(open.size(), 2u);
  EXPECT_EQ(open[0].tag.path, 0u);
  EXPECT_EQ(open[1].tag.path, 2u);
  HitBatch handed_over(1);
  handed_over[0].tag = rays[0].tag;
  EXPECT_EQ(ledger.open({&handed_over, 1}).size(), 1u);
}

TEST(OutstandingRays, RefusesARayThatIsOpenAndOneThatIsNot) {
  OutstandingRays ledger;
  const RayBatch rays(1);
  const HitBatch done(1);
  EXPECT_THROW(ledger.remove(done), SimulationError);
  ledger.add(rays);
  EXPECT_THROW(ledger.add(rays), SimulationError);
  ledger.remove(done);
  ledger.add(rays);
}

}  // namespace
}  // namespace carousel::ringbus
