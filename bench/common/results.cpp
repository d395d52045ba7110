#include "bench/common/results.h"

#include <nlohmann/json.hpp>

namespace carousel::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Spread, median, min, max)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Work, box_tests, triangle_tests, memberships, packet_rays, given_up_after)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Measurement, contestant, threads, wall, cpu, work, hits, disagreements)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SetResult, name, any_hit, rays, hits, digest, measurements)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BuildResult, builder, threads, mtris, bytes_per_triangle)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SceneResult, name, triangles, instances, builds, to_first_packet_seconds, sets)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MachineInfo, cpu, threads, caches, commit, compiler, build_type, simd, embree, date)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BenchResult, machine, settings, repetitions, scenes)

std::string to_json_text(const BenchResult& result) {
  return nlohmann::json(result).dump(1) + "\n";
}

BenchResult from_json_text(const std::string& text) {
  return nlohmann::json::parse(text).get<BenchResult>();
}

const Measurement* find(const SetResult& set, const std::string& contestant, int threads) {
  for (const Measurement& m : set.measurements)
    if (m.contestant == contestant && m.threads == threads) return &m;
  return nullptr;
}

}  // namespace carousel::bench
