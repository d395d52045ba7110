// Test units and links as the queues of queueing theory.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/testers/unit_bank.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

/// Mean and half width of its 99.9 % confidence interval, from the means of 32 batches.
struct Estimate {
  double mean = 0, half_width = 0;
};
class BatchMeans {
 public:
  explicit BatchMeans(std::size_t samples) : batch_((samples + kBatches - 1) / kBatches), sums_(kBatches) {}
  void add(double x) { sums_[count_++ / batch_] += x; }
  Estimate estimate() const {
    Estimate out;
    for (const double sum : sums_) out.mean += sum / static_cast<double>(batch_ * kBatches);
    double squares = 0;
    for (const double sum : sums_) squares += std::pow(sum / static_cast<double>(batch_) - out.mean, 2);
    constexpr double kStudent = 3.633;  // 31 degrees of freedom, two-sided 0.1 %
    out.half_width = kStudent * std::sqrt(squares / (kBatches - 1) / kBatches);
    return out;
  }

 private:
  static constexpr std::size_t kBatches = 32;
  std::size_t batch_, count_ = 0;
  std::vector<double> sums_;
};

constexpr std::size_t kCustomers = 640000;
constexpr Cycle kService = 1000;  // cycles, so that arrivals on whole cycles are nearly as in continuous time

/// Arrivals of a Poisson process that keeps a server with kService busy for `load` of the time.
class PoissonArrivals {
 public:
  explicit PoissonArrivals(double load) : gap_(load / static_cast<double>(kService)) {}
  Cycle next() { return static_cast<Cycle>(at_ += gap_(random_)); }

 private:
  std::mt19937_64 random_{42};
  std::exponential_distribution<double> gap_;
  double at_ = 0;
};

/// Mean wait of an M/D/1 queue in cycles (Pollaczek and Khinchine).
double wait_m_d_1(double load) {
  return load / (2 * (1 - load)) * static_cast<double>(kService);
}

TEST(QueueingTheory, AUnitBankIsAnMD1Queue) {
  for (const double load : {0.2, 0.5, 0.8}) {
    UnitBank bank(TesterUnits{1, static_cast<std::int64_t>(kService), 1});
    PoissonArrivals arrivals(load);
    BatchMeans waits(kCustomers);
    for (std::size_t i = 0; i < kCustomers; ++i) {
      const Cycle at = arrivals.next();
      waits.add(static_cast<double>(bank.reserve(at, 1).first - 1 - at));
    }
    const Estimate wait = waits.estimate();
    EXPECT_LT(wait.half_width, 0.1 * wait.mean);
    EXPECT_NEAR(wait.mean, wait_m_d_1(load), wait.half_width) << "load " << load;
  }
}

/// Sends what arrives over a link, and calls `arrived(number, at)` for each packet's tail, whose place is free at once.
template <class Arrived>
void run_link(double load, const Arrived& arrived, std::vector<Cycle>& created) {
  LooseWire wire;
  OutPort out(wire, 1, 4, kCustomers);
  InPort in{&wire, 1};
  PoissonArrivals arrivals(load);
  for (std::uint32_t i = 0; i < kCustomers; ++i) {
    created.push_back(arrivals.next());
    out.push({.packet = PacketId(i), .rays = 1, .link_cycles = kService}, created.back(), false);
  }
  while (!out.empty()) {
    const Cycle now = out.next(false);
    out.take_credits(now);
    ASSERT_TRUE(out.send(now));
    const Cycle at = in.next();
    arrived(in.take(at).packet.value, at);
  }
}

TEST(QueueingTheory, ALinkIsAnMD1Queue) {
  for (const double load : {0.3, 0.7}) {
    std::vector<Cycle> created;
    BatchMeans waits(kCustomers);
    // The tail arrives when the packet has waited, occupied the link and crossed it.
    run_link(
        load, [&](std::uint32_t i, Cycle at) { waits.add(static_cast<double>(at - created[i] - kService)); }, created);
    const Estimate wait = waits.estimate();
    EXPECT_LT(wait.half_width, 0.1 * wait.mean);
    EXPECT_NEAR(wait.mean, wait_m_d_1(load), wait.half_width) << "load " << load;
  }
}

TEST(QueueingTheory, InATandemOfEqualServersTheSecondOneHasNoQueue) {
  std::vector<Cycle> created;
  UnitBank second(TesterUnits{1, static_cast<std::int64_t>(kService), 1});
  Cycle last = 0;
  run_link(
      0.9,
      [&](std::uint32_t, Cycle at) {
        EXPECT_GE(at, last + kService);  // the first lets out one a service time at most
        last = at;
        EXPECT_EQ(second.reserve(at, 1).first, at + 1);
      },
      created);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
