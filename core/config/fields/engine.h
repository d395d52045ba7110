#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

enum class EngineTransport { kLocal, kMpi };
template <>
inline constexpr auto kEnumNames<EngineTransport> = [] {
  using enum EngineTransport;
  return names<EngineTransport>({{kLocal, "local"}, {kMpi, "mpi"}});
}();

enum class SimdTarget { kAuto, kScalar, kSsse3, kSse4, kAvx2, kAvx3 };
template <>
inline constexpr auto kEnumNames<SimdTarget> = [] {
  using enum SimdTarget;
  return names<SimdTarget>(
      {{kAuto, "auto"}, {kScalar, "scalar"}, {kSsse3, "ssse3"}, {kSse4, "sse4"}, {kAvx2, "avx2"}, {kAvx3, "avx3"}});
}();

/// The shapes or rays that the native engine's kernels test at once within treelets.
enum class Lanes { kBoxes, kRays, kAuto };
template <>
inline constexpr auto kEnumNames<Lanes> = [] {
  using enum Lanes;
  return names<Lanes>({{kBoxes, "boxes"}, {kRays, "rays"}, {kAuto, "auto"}});
}();

struct EngineConfig {
  EngineKind kind = EngineKind::kNative;
  std::optional<std::int64_t> threads;  ///< absent: `auto`
  std::int64_t clock_mhz = 1000;
  SimdTarget simd = SimdTarget::kAuto;
  Lanes lanes = Lanes::kAuto;
  EngineTransport transport = EngineTransport::kLocal;
  std::int64_t memory_limit_mib = 0;  ///< 0: none
  bool what_if = true;
  std::vector<std::string> plugins;  ///< paths, relative to the config's folder, then to the working one
};

/// The clocks of the machine: of the resources, and of the network between them.
struct ClocksConfig {
  std::optional<std::int64_t> core, noc;  ///< MHz
  std::int64_t synchroniser_cycles = 2;
  std::map<std::string, std::int64_t> others{};  ///< MHz, by the name of the clock
};

namespace config {

template <class V>
void describe(V& v, EngineConfig& c) {
  v.choice("kind", c.kind,
           "The native engine has worker threads and real queues; the cycle engine simulates virtual time.");
  v.field_or_auto(
      "threads", c.threads, IntRange{1, 1024}, "threads",
      "The number of worker threads. With auto there are as many as the machine has cores; the cycle engine "
      "simulates a machine of fewer than 64 resources on one of them, and several machines at a time while it "
      "looks for the bottleneck. With auto one thread also runs a larger machine while that is faster, as on a host "
      "with other work.");
  v.field("clock_mhz", c.clock_mhz, IntRange{1, 100'000}, "MHz", "The clock of the simulated machine.");
  v.choice("simd", c.simd, "The instruction set of the test kernels. With auto it is the best that this machine has.");
  v.choice(
      "lanes", c.lanes,
      "How a treelet's rays go through it. With boxes each goes by itself, 24 in turn. With rays they go together, "
      "a list of rays at each node, which is split among its children. auto takes the lists where most of the "
      "treelet's nodes may be met by several rays, and with rays.sort: cells. Lists need the instruction set avx3 "
      "(AVX-512); with any other one rays go by themselves. Hits are the same.");
  v.choice(
      "transport", c.transport,
      "With mpi the processes that mpirun has started play the native engine's machine together, each an arc of its "
      "resources; with local one process plays all of it.");
  v.field("memory_limit_mib", c.memory_limit_mib, IntRange{0, 1 << 30}, "MiB",
          "A process, each rank of several, takes no more memory than this for its data; with 0 there is no limit but "
          "the machine's.");
  v.field(
      "what_if", c.what_if, "",
      "The cycle engine finds the bottleneck: it simulates a part of the rays again, each time with one class of parts "
      "relaxed.");
  v.texts("plugins", c.plugins,
          "Shared libraries that bring queues, policies, placements or workloads, whose names other keys then take. "
          "Their paths are relative to the config's folder, then to the working one.");
}

template <class V>
void describe(V& v, ClocksConfig& c) {
  v.field_or_auto("core", c.core, IntRange{1, 100'000}, "MHz",
                  "The clock of the resources, which is engine.clock_mhz by another name; auto is that.");
  v.field_or_auto("noc", c.noc, IntRange{1, 100'000}, "MHz",
                  "The clock of the links, routers and stops of a graph that name no other; with synthetic traffic its "
                  "resources pass packets on by it, too. auto is that of the resources.");
  v.field("synchroniser_cycles", c.synchroniser_cycles, IntRange{0, 1000}, "cycles",
          "The time, by the clock that is entered, from the first edge after a message has come from the other clock "
          "until it is there. Equal clocks have no synchroniser.");
  v.others(c.others, IntRange{1, 100'000}, "MHz",
           "Any other name is that of a further clock, by which nodes and links of a graph go that name it.");
}

}  // namespace config
}  // namespace carousel
