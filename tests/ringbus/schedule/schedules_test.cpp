// The native engine under schedules that are drawn from seeds: whatever the order of steps, the same hits, nothing
// lost, and an end, also when a resource stops, links fail, or somebody interrupts.
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "tests/ringbus/schedule/reused_paths.h"
#include "tests/ringbus/schedule/seeded_schedule.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

using FaultKind = FaultsConfig::Resource::Kind;
constexpr std::uint32_t kSchedulesAMachine = 40;

FaultsConfig faults_of_a_schedule(std::mt19937& random, std::uint32_t resources) {
  FaultsConfig faults;
  faults.seed = random();
  const auto fraction = [&] { return random() % 2 == 0 ? 0.05 * (1 + random() % 4) : 0.0; };
  if (random() % 3 == 0)
    faults.links = {fraction(), fraction(), fraction(),
                    fraction(), fraction(), 1 + static_cast<std::int64_t>(random() % 1'000'000)};
  FaultsConfig::Resource& resource = faults.resource;
  constexpr FaultKind kKinds[] = {FaultKind::kNone, FaultKind::kPause, FaultKind::kSlow, FaultKind::kStop,
                                  FaultKind::kStop};
  resource.kind = kKinds[random() % std::size(kKinds)];
  resource.number = random() % resources;
  resource.after_rays = random() % 20;
  resource.cycles = 1 + random() % 20'000'000;
  resource.factor = 2 + random() % 8;
  resource.recover = random() % 4 != 0;
  return faults;
}

/// A machine so small that a run takes some thousand points, with anything that decides who waits for whom.
Cell small_machine(std::mt19937& random) {
  const auto one_of = [&](const auto& values) { return values[random() % std::size(values)]; };
  constexpr std::int64_t kFew[] = {1, 2, 4}, kSlots[] = {2, 4, 16}, kRays[] = {1, 3, 8}, kBundles[] = {0, 0, 0, 2, 4};
  constexpr TopologyShape kShapes[] = {TopologyShape::kRing, TopologyShape::kBidirectional,
                                       TopologyShape::kPointToPoint};
  for (;;) {
    Cell cell;
    Config& c = cell.config;
    c.engine.kind = EngineKind::kNative;
    c.topology.resources = 1 + random() % 4;
    c.topology.shape = one_of(kShapes);
    c.topology.flow = random() % 2 == 0 ? Flow::kCredits : Flow::kBubble;
    c.topology.visit = random() % 2 == 0 ? Visit::kAll : Visit::kOwners;
    c.topology.link.depth = one_of(kFew);
    c.topology.link.queue = one_of(queue_kinds());
    c.rays.slots_per_resource = one_of(kSlots);
    c.rays.placement = static_cast<Placement>(random() % 4);
    c.rays.sort = random() % 2 == 0 ? RaySort::kNone : RaySort::kCells;
    c.rays.queue = {one_of(many_to_many_kinds()), one_of(kFew)};
    c.packets.rays = one_of(kRays);
    c.packets.results = random() % 2 == 0 ? PacketResults::kMask : PacketResults::kMessage;
    c.collections.ready = one_of(kRays);
    c.collections.traversal = static_cast<Traversal>(random() % 3);
    c.collections.select = random() % 2 == 0 ? Select::kStrict : Select::kFullFirst;
    c.collections.home = static_cast<Home>(random() % 3);
    c.collections.when_full = random() % 2 == 0 ? WhenFull::kReserve : WhenFull::kSpill;
    c.testers.own_rays = random() % 2 == 0 ? TestersConfig::OwnRays::kBefore : TestersConfig::OwnRays::kAfter;
    c.bundles.size = one_of(kBundles);
    c.shading.workers = 1 + random() % 3;
    c.shading.queue = {one_of(many_to_many_kinds()), one_of(kFew)};
    c.faults = faults_of_a_schedule(random, static_cast<std::uint32_t>(c.topology.resources));
    cell.tight_storage = random() % 2 == 0;
    cell.threads = random() % 4 == 0 ? 2 : 1000;  // two agents play all, or each resource and each worker is one
    if (is_accepted(c)) return cell;
  }
}

/// Counts of the events that the runs of a test met; without some of them the runs would prove little.
struct Tally {
  std::uint64_t points = 0, restarts = 0, without_recovery = 0, resent = 0;
  std::uint64_t interrupted = 0, after_the_last_ray = 0;  // ended so; of these, with packets on their way home
};

/// Runs a tiny scene on one machine after another.
class Trials {
 public:
  /// Runs the cell under a schedule, and interrupts half of the runs. Returns the fault.
  std::string run(Cell cell, std::uint64_t schedule) {
    schedule_.begin(schedule);
    const accel::Accel& accel = scene_.accel(cell.config.bvh, cell.config.cull_planes, cell.config.accuracy);
    const TestScene::Reference& reference = scene_.reference(cell.config.accuracy);
    give_room(cell, accel);
    // The interrupt comes some points after a ray has been shaded, which is often the last one.
    const std::uint64_t ray = schedule_.draw(3) == 0 ? reference.rays : 1 + schedule_.draw(reference.rays);
    const std::uint64_t points = 1 + schedule_.draw(std::uint64_t{1} << schedule_.draw(8));
    const bool interrupt = schedule_.draw(2) == 0;
    const auto numbers = static_cast<std::uint32_t>(1 + schedule_.draw(8));
    ScatterWorkload rays = scene_.workload();
    ReusedPaths workload(rays, numbers, [&](std::uint64_t shaded) {
      if (interrupt && shaded == ray) schedule_.stop_in(points);
    });
    RunOptions options;
    options.threads = cell.threads;
    options.stop = schedule_.stop();
    Outcome out;
    try {
      out.result = run_native(cell.config, accel, scene_.size(), workload, options);
      if (out.result.complete)
        check_outcome(out, cell.config, reference, workload);
      else
        check_interrupted(out, reference, workload);
    } catch (const SimulationError& error) {
      out.fault = error.what();
      if (is_due(out.fault, cell.config.faults.resource)) out.fault.clear();
    }
    count(out.result);
    digest_ = workload.digest();
    return out.fault;
  }

  const Tally& tally() const { return tally_; }
  const SeededSchedule& schedule() const { return schedule_; }
  /// The digest of the hits of the last run.
  const HitsDigest& digest() const { return digest_; }

 private:
  void check_interrupted(Outcome& out, const TestScene::Reference& reference, const ReusedPaths& workload) {
    ++tally_.interrupted;
    tally_.after_the_last_ray += workload.rays() == reference.rays;
    if (!schedule_.stop().stop_requested()) out.fault += "incomplete without an interrupt; ";
    if (workload.doubled() > 0) out.fault += "rays were shaded twice; ";
    if (out.result.rays_completed != workload.rays()) out.fault += "not all completed rays were shaded; ";
    if (out.result.rays_completed > out.result.rays_emitted) out.fault += "more rays completed than emitted; ";
  }
  /// True of the error by which a run ends that lacks rays and may not start them again.
  bool is_due(const std::string& error, const FaultsConfig::Resource& fault) {
    const bool due = fault.kind == FaultKind::kStop && !fault.recover &&
                     error.find("faults.resource.recover is off: ") != std::string::npos &&
                     error.find(": 0 rays are missing") == std::string::npos;
    tally_.without_recovery += due;
    return due;
  }
  void count(const RunResult& result) {
    tally_.points += schedule_.points();
    tally_.restarts += result.rays_restarted > 0;
    for (const LinkResult& link : result.links) tally_.resent += link.faults.resent;
  }

  TestScene scene_{builtin_scene(BuiltinScene::kTerrain, 60, 0), 12, 2};
  SeededSchedule schedule_;
  HitsDigest digest_;
  Tally tally_;
};

/// The number of the first schedule: 0, or CAROUSEL_SCHEDULE, by which a failure is repeated at once.
std::uint32_t first_schedule() {
  const char* number = std::getenv("CAROUSEL_SCHEDULE");
  return number != nullptr ? static_cast<std::uint32_t>(std::strtoul(number, nullptr, 10)) : 0u;
}
std::uint64_t schedule_seed(std::uint32_t schedule) {
  return std::uint64_t{run_seed()} << 32 | schedule;
}
Cell machine_of(std::uint32_t schedule) {
  std::seed_seq seed{run_seed(), schedule / kSchedulesAMachine};
  std::mt19937 random(seed);
  return small_machine(random);
}
std::string repeated_by(std::uint32_t schedule, const char* test) {
  return fmt::format("again: CAROUSEL_SEED={} CAROUSEL_SCHEDULE={} ringbus_tests --gtest_filter=Schedules.{}",
                     run_seed(), schedule, test);
}

TEST(Schedules, ChangeNoHitAndLoseNothing) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "all agents share a thread";
#endif
  Trials trials;
  Cell cell;
  const std::uint32_t first = first_schedule(), count = static_cast<std::uint32_t>(scaled(3000, 1500));
  for (std::uint32_t i = first; i < first + count; ++i) {
    if (i == first || i % kSchedulesAMachine == 0) cell = machine_of(i);
    ASSERT_EQ(trials.run(cell, schedule_seed(i)), "") << cell.text() << '\n'
                                                      << repeated_by(i, "ChangeNoHitAndLoseNothing");
  }
  const Tally& tally = trials.tally();
  std::cout << count << " schedules, " << tally.points << " points, " << tally.restarts << " restarts, "
            << tally.without_recovery << " ended for lack of rays, " << tally.resent << " frames sent again, "
            << tally.interrupted << " interrupted, " << tally.after_the_last_ray << " of them after the last ray\n";
  EXPECT_GT(tally.restarts, 0u);
  EXPECT_GT(tally.without_recovery, 0u);
  EXPECT_GT(tally.resent, 0u);
  EXPECT_GT(tally.interrupted, tally.after_the_last_ray);
  EXPECT_GT(tally.after_the_last_ray, 0u) << "no interrupt came between the last ray and the last packet at home";
}

TEST(Schedules, AreTheSameForTheSameSeed) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "all agents share a thread";
#endif
  const auto facts = [](Trials& trials, std::uint32_t i) {
    const std::string fault = trials.run(machine_of(i), schedule_seed(i));
    const SeededSchedule& schedule = trials.schedule();
    return fmt::format("{} {} {} {}", fault, schedule.points(), schedule.choices(), trials.digest().hex());
  };
  Trials trials;
  std::vector<std::string> once;
  for (std::uint32_t i = 0; i < 30; ++i) once.push_back(facts(trials, i * kSchedulesAMachine));
  for (std::uint32_t i = 30; i-- > 0;) EXPECT_EQ(facts(trials, i * kSchedulesAMachine), once[i]) << i;
  EXPECT_NE(once[0], once[1]);
}

}  // namespace
}  // namespace carousel::ringbus
