// Links that fail, and what makes them good again.
#include "ringbus/faults/reliable_link.h"

#include <array>
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "ringbus/faults/link_fault_timer.h"
#include "ringbus/faults/retry_ledger.h"
#include "ringbus/queues/queue_types.h"
#include "tests/ringbus/queue_kinds.h"

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
      if (f.drop > 0) { EXPECT_GT(got.faults.resent, 0u); }
      EXPECT_GT(got.faults.resent + got.faults.discarded, 0u);
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

TEST(FaultDice, TheSameSeedGivesTheSameFates) {
  Config config = faulty(0.25, 0, 0.5, 0, 0);
  LinkFaultCounts a, b, other;
  FaultDice first(config.faults, 5), again(config.faults, 5), stream(config.faults, 6);
  std::uint64_t drops = 0, same = 0;
  for (int i = 0; i < 4000; ++i) {
    const FrameFate fate = first.next(a), twin = again.next(b), else_where = stream.next(other);
    EXPECT_EQ(fate.drop, twin.drop);
    EXPECT_EQ(fate.bits, twin.bits);
    drops += fate.drop;
    same += fate.bits == else_where.bits;
  }
  EXPECT_EQ(a, b);
  EXPECT_EQ(same, 0u);
  EXPECT_NEAR(static_cast<double>(drops), 1000, 150);
  EXPECT_NEAR(static_cast<double>(a.corrupted), 1500, 150);   // of those not dropped
}

TEST(LinkFaultTimer, LosesTimeAndNothingElse) {
  Config config;
  config.faults.links.drop = 0.5;
  cycle::LinkFaultTimer timer(config.faults, 0);
  cycle::Cycle now = 0, last = 0;
  std::uint64_t waited = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto delivery = timer.send(now, 2, 10);
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
  EXPECT_NEAR(static_cast<double>(waited), 2000, 250);   // a geometric distribution of mean 1
}

TEST(RetryLedger, HoldsWhatHasNotBeenShaded) {
  RetryLedger ledger;
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
}

}  // namespace
}  // namespace carousel::ringbus
