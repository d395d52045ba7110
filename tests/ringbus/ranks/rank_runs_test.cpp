#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "core/config/load/load.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "ringbus/native/native_engine.h"
#include "scene/builtin/builtin.h"
#include "scene/load_scene.h"
#include "shading/effects/effects_plan.h"
#include "shading/tracer/path_tracer.h"
#include "tests/ringbus/identity/machine_space.h"
#include "tests/ringbus/ranks/thread_transport.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {
namespace {

// Of all suites this one takes longest under ThreadSanitizer: there half of the picture, over one number of ranks. A
// rank is a process, and its threads are the same beside four others.
constexpr std::uint64_t kSamples = kThreadSanitizer ? 1 : 2;
constexpr const char* kRankMachine =
    "scene: {builtin: cornell}\n"
    "image: {width: 24, height: 16, max_depth: 3}\n"
    "engine: {kind: native, threads: 1}\n"
    "topology: {resources: 5, link: {depth: 4}}\n"
    "packets: {rays: 8}\n"
    "collections: {ready: 8}\n"
    "rays: {slots_per_resource: 24}\n";

/// Passes a workload's calls on, and fails or asks for an end when a rank has shaded so much.
class RankWorkload final : public Workload {
 public:
  RankWorkload(Workload& inner, std::function<void(std::size_t)> shaded) : inner_(inner), shaded_(std::move(shaded)) {}
  Generated generate(WorkerId worker, std::size_t most, RayBatch& out) override {
    return inner_.generate(worker, most, out);
  }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    inner_.shade(worker, completed, out);
    if (shaded_) shaded_(completed.size());
  }

 private:
  Workload& inner_;
  std::function<void(std::size_t)> shaded_;
};

class RankRuns : public testing::Test {
 protected:
  struct Ended {
    std::string hits, image, fault;
    RunResult result;
  };

  void load(std::vector<std::string> sets) {
    sets.push_back(fmt::format("image.samples={}", kSamples));
    config_ = load_config({kRankMachine, "ranks.yaml"}, sets).config;
    scene_ = scene::load_scene(
        config_.scene, {}, [](const std::string&) {}, {}, scene::View{config_.camera, 1.5f});
    shading::strip_effects(scene_, config_.shading.effects);
    accel_ = accel::build(scene_, config_.bvh, *make_tbb_executor(1), config_.accuracy);
  }
  /// The part of the picture that rank `transport` makes; all of it without one.
  Ended trace(Transport* transport, const std::function<void(std::size_t)>& shaded = {}, std::stop_token stop = {}) {
    if (transport == nullptr || config_.scene.placement == ScenePlacement::kReplicated)
      return trace(transport, shaded, std::move(stop), accel_);
    const accel::BuildRanks ranks{transport->rank(), transport->ranks(),
                                  [transport](const std::string& bytes) { return transport->gather(bytes); }};
    return trace(
        transport, shaded, std::move(stop),
        accel::build(scene_, config_.bvh, *make_tbb_executor(1), config_.accuracy, config_.cull_planes, &ranks));
  }
  Ended trace(Transport* transport, const std::function<void(std::size_t)>& shaded, std::stop_token stop,
              const accel::Accel& accel) {
    shading::PathTracer tracer(scene_, config_, 4096, static_cast<std::size_t>(shader_workers(config_)));
    std::optional<shading::PathSample> share;
    RunOptions options;
    options.threads = static_cast<std::size_t>(*config_.engine.threads);
    options.transport = transport;
    options.stop = stop;
    options.timeline.most = slices_;
    if (transport != nullptr) {
      share = shading::share_of_paths(24 * 16 * kSamples, transport->rank(), transport->ranks());
      tracer.set_sample(&*share);
    }
    RankWorkload workload(tracer, shaded);
    Ended out;
    try {
      out.result = run_native(config_, accel, 3.0f, workload, options);
      if (transport != nullptr) {
        std::vector<std::uint64_t> sums = tracer.sums();
        transport->sum(sums);
        tracer.set_sums(sums);
      }
      out.hits = tracer.hits_digest().hex();
      out.image = tracer.image_digest();
    } catch (const std::exception& error) {
      out.fault = error.what();
    }
    return out;
  }
  std::vector<Ended> over(std::uint32_t ranks, const std::function<void(std::uint32_t, std::size_t)>& shaded = {},
                          std::vector<std::stop_token> stops = {}) {
    RankThreads all(ranks);
    std::vector<Ended> out(ranks);
    stops.resize(ranks);
    {
      std::vector<std::jthread> threads;
      for (std::uint32_t r = 0; r < ranks; ++r)
        threads.emplace_back([&, r] {
          ThreadTransport transport(all, r);
          std::function<void(std::size_t)> mine;
          if (shaded) mine = [&, r](std::size_t rays) { shaded(r, rays); };
          out[r] = trace(&transport, mine, stops[r]);
        });
    }
    return out;
  }

  std::size_t slices_ = 0;  // most slices of a timeline
  Config config_;
  scene::Scene scene_;
  accel::Accel accel_;
};

TEST_F(RankRuns, GiveTheHitsAndThePictureOfOneProcess) {
  const std::vector<std::vector<std::string>> machines{
      {},
      {"topology.shape=bidirectional", "engine.threads=2"},
      {"topology.shape=point_to_point", "topology.visit=owners"},
      {"topology.flow=bubble", "topology.link.depth=2", "collections.traversal=ordered"},
      {"collections.home=local", "topology.link.depth=1"},
      {"rays.placement=round_robin", "rays.slots_per_resource=5", "collections.traversal=treelet"},
  };
  for (const auto& sets : machines) {
    SCOPED_TRACE(testing::PrintToString(sets));
    load(sets);
    const Ended alone = trace(nullptr);
    ASSERT_EQ(alone.fault, "");
    for (const std::uint32_t ranks : kThreadSanitizer ? std::vector{2u} : std::vector{2u, 5u}) {
      const std::vector<Ended> ended = over(ranks);
      for (const Ended& rank : ended) {
        ASSERT_EQ(rank.fault, "");
        EXPECT_TRUE(rank.result.complete);
        EXPECT_EQ(rank.result.rays_completed, alone.result.rays_completed);  // joined at every rank
        EXPECT_EQ(rank.result.ranks.size(), ranks);
      }
      EXPECT_EQ(ended[0].hits, alone.hits);
      EXPECT_EQ(ended[0].image, alone.image);
      ResourceStatistics sum;
      for (const ResourceStatistics& r : ended[0].result.resources) sum += r;
      EXPECT_EQ(sum.rays_completed, alone.result.rays_completed);
      EXPECT_EQ(sum.packets_retired, sum.packets_issued);
    }
  }
}

TEST_F(RankRuns, GiveThemWithAPartitionedScene) {
  const std::vector<std::string> partitioned{"scene={builtin: instances, instances: 60, placement: partitioned}",
                                             "engine.transport=mpi", "collections={home: hash, when_full: spill}"};
  const std::vector<std::vector<std::string>> machines{
      {},
      {"topology.shape=bidirectional", "engine.threads=2", "collections.traversal=ordered"},
      {"topology.shape=point_to_point", "topology.visit=owners", "bvh.mixed_triangles=2"},
      {"collections.traversal=treelet", "bvh.treelet_triangles=64", "topology.flow=bubble", "topology.link.depth=2"},
      {"collections.traversal=treelet", "engine.threads=2"},
      {"scene={builtin: spheres, triangles: 300, procedural: true, placement: partitioned}"},
      {"scene={builtin: terrain, triangles: 2000, placement: partitioned}", "bvh.mixed_triangles=4"},
      {"packets.shapes=single"},
  };
  bool odd = false;
  for (const auto& sets : machines) {
    odd = !odd;
    std::vector<std::string> all = partitioned;
    all.insert(all.end(), sets.begin(), sets.end());
    SCOPED_TRACE(testing::PrintToString(sets));
    load(all);
    const Ended alone = trace(nullptr);
    ASSERT_EQ(alone.fault, "");
    std::vector<std::uint32_t> numbers = odd ? std::vector{3u, 1u} : std::vector{2u, 5u};
    if (kThreadSanitizer) numbers.pop_back();
    for (const std::uint32_t ranks : numbers) {
      SCOPED_TRACE(ranks);
      const std::vector<Ended> ended = over(ranks);
      std::uint64_t structure = 0, largest = 0, shapes = 0;
      for (const Ended& rank : ended) {
        ASSERT_EQ(rank.fault, "");
        EXPECT_EQ(rank.result.rays_completed, alone.result.rays_completed);
        for (const RankResult& of : rank.result.ranks) largest = std::max(largest, of.memory.structure_bytes);
      }
      EXPECT_EQ(ended[0].hits, alone.hits);
      EXPECT_EQ(ended[0].image, alone.image);
      if (ranks == 1) continue;
      for (const RankResult& rank : ended[0].result.ranks) {
        structure += rank.memory.structure_bytes;
        for (const RankCounts& to : rank.to) shapes += to.shapes;
      }
      EXPECT_LT(largest, accel_.size_bytes());  // no rank has it all
      EXPECT_GT(structure, accel_.size_bytes() / 2);
      EXPECT_GT(shapes, 0u);
    }
  }
}

// Machines of the covering array's factors, those that ranks may share.
TEST_F(RankRuns, RandomMachinesGiveOneAnswer) {
  std::mt19937 random(4409 * run_seed());
  MachineSpace& space = all_machines();
  std::vector<std::string> with{"engine.kind=native", "bundles.size=0", "rays.placement!=first_taker"};
  const Domains replicated = space.domains(with);
  with.insert(with.end(), {"cull_planes.count=0", "bvh.elements=boxes", "bvh.levels=2", "bvh.top_triangles=0",
                           "bvh.merge=none", "packets.shapes=strip", "collections.home=hash"});
  const Domains partitioned = space.domains(with);
  int refused = 0;
  for (int left = cell_count(12); left > 0;) {
    const bool parts = left % 2 == 0;
    const std::optional<Row> row = space.draw(random, parts ? partitioned : replicated);
    ASSERT_TRUE(row);
    std::vector<std::string> sets{"engine.transport=mpi", "scene.triangles=600", "scene.instances=30"};
    for (const std::string& set : space.assignments(*row))
      if (!set.starts_with("test.")) sets.push_back(set);
    if (parts) sets.push_back("scene.placement=partitioned");
    SCOPED_TRACE(fmt::format("{}", fmt::join(sets, " ")));
    try {
      load(sets);
    } catch (const ConfigError&) {
      ASSERT_LT(++refused, 5000);
      continue;
    }
    const std::uint32_t ranks = 2 + static_cast<std::uint32_t>(random() % 2);
    if (config_.topology.resources < ranks || config_.rays.slots_per_resource < ranks)
      continue;  // refused by RankScope
    --left;
    const Ended alone = trace(nullptr);
    ASSERT_EQ(alone.fault, "");
    const std::vector<Ended> ended = over(ranks);
    for (const Ended& rank : ended) {
      ASSERT_EQ(rank.fault, "");
      EXPECT_EQ(rank.result.rays_completed, alone.result.rays_completed);
    }
    EXPECT_EQ(ended[0].hits, alone.hits);
    EXPECT_EQ(ended[0].image, alone.image);
  }
}

TEST_F(RankRuns, HaveOneTimeline) {
  load({"engine.threads=2"});
  slices_ = 1'000'000;
  const Ended run = over(3)[0];
  ASSERT_EQ(run.fault, "");
  ASSERT_TRUE(run.result.timeline);
  const Timeline& timeline = *run.result.timeline;
  EXPECT_EQ(timeline.clocks.size(), 3u);
  EXPECT_FALSE(timeline.cut);
  std::map<std::uint64_t, std::uint64_t> sent;
  std::map<std::uint64_t, std::set<std::string>> parts;  // that a packet was at
  std::size_t received = 0, travelled = 0;
  for (const Slice& slice : timeline.slices)
    if (slice.kind == SliceKind::kSend) {
      EXPECT_TRUE(sent.emplace(slice.trip, slice.begin).second);
    }
  for (const Slice& slice : timeline.slices) {
    if (slice.kind == SliceKind::kReceive) {
      ++received;
      ASSERT_TRUE(sent.contains(slice.trip));
      EXPECT_GE(slice.begin, sent[slice.trip]);
    } else if (slice.kind != SliceKind::kSend) {
      ASSERT_NE(slice.trip, 0u);  // it has come along from the packet's owner
      parts[slice.trip].insert(timeline.tracks[slice.track].part);
    }
  }
  std::uint64_t messages = 0, packets = 0;
  for (const RankResult& rank : run.result.ranks)
    for (const RankCounts& to : rank.to) messages += to.messages;
  for (const ResourceStatistics& resource : run.result.resources) packets += resource.packets_issued;
  EXPECT_EQ(sent.size(), messages);
  EXPECT_EQ(received, messages);
  EXPECT_EQ(parts.size(), packets);
  for (const auto& [trip, at] : parts) travelled += at.size() == 3 ? 1 : 0;
  EXPECT_GT(travelled, packets / 2);
}

TEST_F(RankRuns, EndWithTheRankThatFails) {
  load({});
  const std::vector<Ended> ended = over(3, [](std::uint32_t rank, std::size_t) {
    if (rank == 1) throw SimulationError("the lamp is broken");
  });
  EXPECT_EQ(ended[1].fault, "the lamp is broken");
  EXPECT_EQ(ended[0].fault, "the run was ended by rank 1: the lamp is broken");
  EXPECT_EQ(ended[2].fault, "the run was ended by rank 1: the lamp is broken");
}

TEST_F(RankRuns, StopTogether) {
  load({});
  std::stop_source stop;
  const std::vector<Ended> ended =
      over(3,
           [&](std::uint32_t rank, std::size_t) {
             if (rank == 2) stop.request_stop();
             std::this_thread::sleep_for(std::chrono::milliseconds(50));  // there is time to notice
           },
           {{}, {}, stop.get_token()});
  for (const Ended& rank : ended) {
    EXPECT_EQ(rank.fault, "");
    EXPECT_FALSE(rank.result.complete);
  }
}

}  // namespace
}  // namespace carousel::ringbus
