// Testers behind a distributor, against a machine that is played cycle by cycle.
#include "ringbus/cycle/testers/distributor.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle {
namespace {

struct PlayedPacket {
  Cycle at = 0;
  std::vector<std::uint32_t> slots;
  IntersectionCounts counts;
  std::uint64_t shape_bytes = 0;
};

/// Asks in every cycle what each part may do. Knows nothing of the times to come.
class PlayedDistributor {
 public:
  PlayedDistributor(const TestersConfig& config, const LinkConfig& link, const std::vector<PlayedPacket>& packets)
      : c_(config),
        latency_(static_cast<Cycle>(link.latency_cycles)),
        width_(static_cast<std::uint64_t>(link.bytes_per_cycle)),
        packets_(packets),
        testers_(static_cast<std::size_t>(config.distributor.testers)),
        decided_(packets.size()),
        shapes_at_(packets.size(), kNever),
        undecided_(packets.size()) {
    for (OneTester& one : testers_) {
      one.places = c_.distributor.queue;
      one.result_places = c_.distributor.results;
    }
    for (std::size_t p = 0; p < packets.size(); ++p) {
      decided_[p].assign(packets[p].slots.size(), 0);
      undecided_[p] = packets[p].slots.size();
      left_ += packets[p].slots.size();
    }
  }

  /// The cycles in which the results have passed the decision point.
  std::vector<std::vector<Cycle>> play() {
    for (Cycle now = 0; left_ > 0; ++now) {
      for (OneTester& one : testers_) {
        one.places += std::erase(one.place_comes, now);
        one.result_places += std::erase(one.result_place_comes, now);
      }
      bus(now);
      // A place that is given back in a cycle may be taken in it, where the way takes no time.
      decision_point(now);
      for (OneTester& one : testers_) test(one, now);
      hand_out(now);
    }
    return decided_;
  }

 private:
  struct Ray {
    std::size_t packet = 0, index = 0;
    Cycle at = 0;  // its ID comes, or its result
  };
  struct OneTester {
    std::deque<Ray> queue;
    std::deque<Ray> results;
    std::int64_t places = 0, result_places = 0;
    std::vector<Cycle> place_comes, result_place_comes;
    Cycle busy_until = 0, last_result = 0;
  };

  void bus(Cycle now) {
    if (bus_next_ == packets_.size() || packets_[bus_next_].at > now || bus_until_ > now) return;
    bus_until_ = now + ceil_div(packets_[bus_next_].shape_bytes, width_);
    shapes_at_[bus_next_++] = bus_until_ + latency_;
    bus(now);  // shapes without bytes take no time
  }

  void decision_point(Cycle now) {
    for (std::int64_t i = 0; i < c_.distributor.results_per_cycle; ++i) {
      OneTester* oldest = nullptr;
      for (OneTester& one : testers_) {
        if (one.results.empty() || one.results.front().at > now) continue;
        if (oldest == nullptr || before(one.results.front(), oldest->results.front())) oldest = &one;
      }
      if (oldest == nullptr) return;
      const Ray ray = oldest->results.front();
      oldest->results.pop_front();
      oldest->result_place_comes.push_back(now + latency_);
      decided_[ray.packet][ray.index] = now + 1;
      --undecided_[ray.packet];
      --left_;
    }
  }
  static bool before(const Ray& a, const Ray& b) {
    return a.packet != b.packet ? a.packet < b.packet : a.index < b.index;
  }

  bool older_done(std::size_t packet, Cycle now) const {
    const auto ahead = static_cast<std::size_t>(c_.distributor.out_of_order);
    for (std::size_t p = 0; p + ahead < packet; ++p) {
      if (undecided_[p] > 0) return false;
      for (const Cycle done : decided_[p])
        if (done + latency_ > now) return false;
    }
    return true;
  }

  void test(OneTester& one, Cycle now) {
    if (one.queue.empty() || one.busy_until > now || one.result_places == 0) return;
    const Ray ray = one.queue.front();
    // The record is read in the cycle after the ID has come.
    if (ray.at + 1 > now || shapes_at_[ray.packet] > now || !older_done(ray.packet, now)) return;
    one.queue.pop_front();
    one.place_comes.push_back(now + latency_);
    --one.result_places;
    const PlayedPacket& packet = packets_[ray.packet];
    Cycle busy = 1, answer = 0;
    for (const UnitKind kind : {UnitKind::kBox, UnitKind::kTriangle}) {
      const std::uint64_t all = packet.counts.*unit_row(kind).tests, rays = packet.slots.size();
      const std::uint64_t tests = all / rays + (ray.index < all % rays ? 1 : 0);
      if (tests == 0) continue;
      const TesterUnits& units = c_.units[kind];
      const Cycle starts = ceil_div(tests, static_cast<std::uint64_t>(units.units)),
                  interval = static_cast<Cycle>(units.interval_cycles);
      busy = std::max(busy, starts * interval);
      answer = std::max(answer, (starts - 1) * interval + static_cast<Cycle>(units.latency_cycles));
    }
    one.busy_until = now + busy;
    one.last_result = std::max(one.last_result, now + answer);
    one.results.push_back({ray.packet, ray.index, one.last_result + latency_});
  }

  void hand_out(Cycle now) {
    for (std::int64_t i = 0; i < c_.distributor.ids_per_cycle; ++i) {
      if (packet_ == packets_.size() || packets_[packet_].at > now) return;
      OneTester& one = testers_[packets_[packet_].slots[index_] % testers_.size()];
      if (one.places == 0) return;
      --one.places;
      one.queue.push_back({packet_, index_, now + latency_});
      if (++index_ < packets_[packet_].slots.size()) continue;
      index_ = 0;
      ++packet_;
      return;  // the next packet's IDs have a cycle of their own
    }
  }

  const TestersConfig& c_;
  Cycle latency_;
  std::uint64_t width_;
  const std::vector<PlayedPacket>& packets_;
  std::vector<OneTester> testers_;
  std::vector<std::vector<Cycle>> decided_;
  std::vector<Cycle> shapes_at_;
  std::vector<std::size_t> undecided_;
  std::size_t left_ = 0, packet_ = 0, index_ = 0, bus_next_ = 0;
  Cycle bus_until_ = 0;
};

TEST(Distributor, DividesNoProgramAmongTesters) {
  const std::vector<std::uint32_t> slots{0, 1, 2, 3};
  const auto decided = [&](std::uint64_t programs, std::uint64_t cycles) {
    IntersectionCounts counts;
    counts.procedural = 1;
    counts.programs = programs;
    counts.program_cycles = cycles;
    std::vector<Cycle> out;
    BankOverlap overlap(0);
    Distributor(TestersConfig{}, RayStages{}, LinkConfig{}).test(10, slots, counts, 64, overlap, out);
    return out;
  };
  EXPECT_EQ(decided(1, 100).front(), decided(0, 0).front() + 99);
}

TEST(Distributor, AgreesWithAMachinePlayedCycleByCycle) {
  std::mt19937 random(7);
  const auto upto = [&](std::uint32_t most) { return static_cast<std::int64_t>(random() % most); };
  std::uint64_t waited = 0, held = 0, full = 0, undecided = 0, ahead = 0;
  for (int machine = 0; machine < 400; ++machine) {
    TestersConfig config;
    config.distributor.testers = 1 + upto(6);
    config.distributor.ids_per_cycle = 1 + upto(5);
    config.distributor.queue = 1 + upto(6);
    config.distributor.out_of_order = upto(4);
    config.distributor.results_per_cycle = 1 + upto(3);
    config.distributor.results = 1 + upto(4);
    for (const UnitKind kind : {UnitKind::kBox, UnitKind::kTriangle})
      config.units[kind] = {1 + upto(4), 1 + upto(3), 1 + upto(20)};
    LinkConfig link;
    link.latency_cycles = 1 + upto(5);
    link.bytes_per_cycle = 1 + upto(64);
    std::vector<PlayedPacket> packets;
    Cycle at = 0;
    for (int i = 0; i < 20; ++i) {
      at += static_cast<Cycle>(upto(2) * upto(60));
      PlayedPacket packet{.at = at, .slots = {}, .counts = {}, .shape_bytes = static_cast<std::uint64_t>(upto(300))};
      const auto rays = static_cast<std::size_t>(1 + upto(12));
      for (std::size_t r = 0; r < rays; ++r) packet.slots.push_back(static_cast<std::uint32_t>(upto(64)));
      packet.counts.box = static_cast<std::uint64_t>(upto(2) * upto(8)) * rays;
      packet.counts.triangle = static_cast<std::uint64_t>(upto(40)) + (packet.counts.box == 0 ? 1 : 0);
      packets.push_back(std::move(packet));
    }
    Distributor distributor(config, {}, link);
    BankOverlap overlap(0);
    const std::vector<std::vector<Cycle>> played = PlayedDistributor(config, link, packets).play();
    for (std::size_t p = 0; p < packets.size(); ++p) {
      std::vector<Cycle> decided;
      distributor.test(packets[p].at, packets[p].slots, packets[p].counts, packets[p].shape_bytes, overlap, decided);
      ASSERT_EQ(decided, played[p]) << "machine " << machine << " packet " << p;
    }
    waited += distributor.counts().queue_full;
    held += distributor.counts().held_back;
    full += distributor.counts().results_full;
    undecided += distributor.counts().undecided;
    ahead += distributor.counts().ahead;
  }
  EXPECT_TRUE(waited > 0 && held > 0 && full > 0 && undecided > 0 && ahead > 0);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
