// Measures the collection store alone: rays join collections of random nodes and are removed a block at a time.
#include <cstdint>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/numeric/rng.h"
#include "ringbus/resource/collections/collection_store.h"

namespace carousel::bench {

namespace {

constexpr std::uint32_t kPacketRays = 256;

/// Items are ray IDs, each added and taken once. The argument is how many nodes they are for; about 32 IDs
/// join a collection at a time, as when a packet retires.
void collections_add_take(benchmark::State& state) {
  const auto nodes = static_cast<std::uint32_t>(state.range(0));
  ringbus::CollectionStore store({.block_rays = kPacketRays,
                                  .ready = kPacketRays,
                                  .capacity_blocks = 1u << 16,
                                  .policy = Policy::kNearest,
                                  .select = Select::kStrict,
                                  .scene_size = 1,
                                  .max_depth = 16});
  std::vector<ringbus::RayId> rays(32), taken;
  std::uint32_t step = 0;
  std::int64_t items = 0;
  const auto add = [&] {
    const PhiloxCounter random = random_block({.seed = 1, .pixel = step++}, 0);
    const accel::NodeKey key{0, accel::NodeRef::inner(random[0] % nodes)};
    store.add(key, static_cast<std::uint16_t>(random[1] % 16), unit_float(random[2]), rays);
  };
  while (store.memberships() < 65536) add();  // as full as a resource of 65,536 rays keeps it
  for (auto _ : state) {
    add();
    while (store.memberships() > 65536) {
      const std::optional<ringbus::CollectionId> best = store.best(true);
      store.take(*best, taken);
      items += static_cast<std::int64_t>(taken.size());
      benchmark::DoNotOptimize(taken.data());
    }
  }
  state.SetItemsProcessed(items);
}
BENCHMARK(collections_add_take)->Arg(64)->Arg(1024)->Arg(16384);

}  // namespace

}  // namespace carousel::bench
