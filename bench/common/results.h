#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bench/common/stopwatch.h"

namespace carousel::bench {

// The results of a run of bench_rays: one JSON file, from which the tables are made.

/// Counts per ray; 0 if unknown (the ring reports them with statistics only, Embree never).
struct Work {
  double box_tests = 0, triangle_tests = 0;
  double memberships = 0;            ///< times it joined a collection
  double packet_rays = 0;            ///< mean rays a packet
  std::uint64_t given_up_after = 0;  ///< rays; 0 when all were traced
};

/// One contestant on one ray set with one number of threads.
struct Measurement {
  std::string contestant;
  int threads = 1;
  Spread wall{};  ///< million rays a second
  Spread cpu{};   ///< million rays a second of CPU time
  Work work{};
  std::uint64_t hits = 0;
  std::uint64_t disagreements = 0;  ///< rays on whose hit the reference differs (Embree: on whether there is one)
};

struct SetResult {
  std::string name;
  bool any_hit = false;
  std::uint64_t rays = 0, hits = 0;
  std::string digest;  ///< digest of the reference's hits, and so of every ring's
  std::vector<Measurement> measurements;
};

/// Building the acceleration structure.
struct BuildResult {
  std::string builder;
  int threads = 1;
  Spread mtris;  ///< million triangles a second
  double bytes_per_triangle = 0;
};

struct SceneResult {
  std::string name;
  std::uint64_t triangles = 0;  ///< triangles of all meshes, each counted once
  std::uint64_t instances = 0;
  std::vector<BuildResult> builds;
  double to_first_packet_seconds = 0;  ///< from the loaded scene: build on all threads, then the ring set up
  std::vector<SetResult> sets;
};

struct MachineInfo {
  std::string cpu;
  int threads = 0;     ///< logical processors
  std::string caches;  ///< "L1d 32K, L2 1M, L3 32M", as the kernel reports
  std::string commit, compiler, build_type, simd, embree;
  std::string date;  ///< UTC, ISO 8601
};

struct BenchResult {
  MachineInfo machine;
  std::map<std::string, std::string> settings;
  int repetitions = 0;
  std::vector<SceneResult> scenes;
};

std::string to_json_text(const BenchResult& result);
/// Throws std::runtime_error for a text that to_json_text did not write.
BenchResult from_json_text(const std::string& text);

/// Null when there is none.
const Measurement* find(const SetResult& set, const std::string& contestant, int threads);

}  // namespace carousel::bench
