#include "bench/fewer_tests/fewer_tests.h"

#include <cstring>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/common/result_json.h"

namespace carousel::bench {

namespace {

using Json = nlohmann::ordered_json;

struct Traced {
  HitList hits;
  IntersectionCounts tests;
  double seconds = 0;
};

Traced traced(const TestVariant& variant, const RaySet& rays) {
  Traced out;
  out.hits.resize(rays.size);
  const Stopwatch stopwatch;
  variant.trace(rays, out.hits, out.tests);
  out.seconds = stopwatch.elapsed().cpu;
  return out;
}

bool same_bits(const HitList& a, const HitList& b, bool any_hit) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (any_hit ? a[i].valid() != b[i].valid() : std::memcmp(&a[i], &b[i], sizeof(Hit)) != 0) return false;
  return true;
}

}  // namespace

FewerTestsResult measure_variants(const std::string& scene, const RaySet& rays,
                                  const std::vector<TestVariant>& variants, int repetitions) {
  FewerTestsResult out{scene, rays.name, rays.size, {}};
  std::vector<std::vector<double>> seconds(variants.size()), ratios(variants.size());
  std::optional<HitList> expected;
  std::vector<IntersectionCounts> tests(variants.size());
  for (int round = 0; round < repetitions; ++round) {
    for (std::size_t k = 0; k < variants.size(); ++k) {
      const std::size_t i = (k + static_cast<std::size_t>(round)) % variants.size();
      const Traced run = traced(variants[i], rays);
      if (!expected) expected = run.hits;
      if (!same_bits(run.hits, *expected, rays.any_hit))
        throw std::runtime_error(
            fmt::format("{}, {}: {} {} gives other hits", scene, rays.name, variants[i].method, variants[i].setting));
      seconds[i].push_back(run.seconds);
      tests[i] = run.tests;
    }
    for (std::size_t i = 0; i < variants.size(); ++i) ratios[i].push_back(seconds[i].back() / seconds[0].back());
  }
  for (std::size_t i = 0; i < variants.size(); ++i) {
    for (double& s : seconds[i]) s *= 1e9 / static_cast<double>(rays.size);
    out.variants.push_back(
        {variants[i].method, variants[i].setting, tests[i], spread_of(seconds[i]), spread_of(ratios[i])});
  }
  return out;
}

std::string to_json_text(const FewerTestsBench& bench) {
  Json out{{"machine", json_of(bench.machine)}, {"repetitions", bench.repetitions}, {"results", Json::array()}};
  for (const FewerTestsResult& r : bench.results) {
    Json variants = Json::array();
    for (const VariantSpeed& v : r.variants)
      variants.push_back({{"method", v.method},
                          {"setting", v.setting},
                          {"nanoseconds_per_ray", json_of(v.nanoseconds_per_ray)},
                          {"ratio", json_of(v.ratio)},
                          {"box_tests", v.tests.box},
                          {"triangle_tests", v.tests.triangle},
                          {"plane_tests", v.tests.plane},
                          {"bundle_tests", v.tests.bundle}});
    out["results"].push_back(
        {{"scene", r.scene}, {"rays", r.rays}, {"count", r.count}, {"variants", std::move(variants)}});
  }
  return out.dump(2) + "\n";
}

std::string fewer_tests_table(const FewerTestsBench& bench, const std::string& method) {
  std::string out;
  for (const FewerTestsResult& r : bench.results) {
    if (r.variants.front().method != method) continue;
    std::string line = fmt::format("| {}, {} |", r.scene, r.rays), head = "| scene, rays |", rule = "|---|";
    for (const VariantSpeed& v : r.variants) {
      head += fmt::format(" {} |", v.setting);
      rule += "---:|";
      line += &v == &r.variants.front()
                  ? fmt::format(" {:.0f} ns |", v.nanoseconds_per_ray.median)
                  : fmt::format(" {:.0f} ns ({:.2f}, {:.2f} to {:.2f}) |", v.nanoseconds_per_ray.median, v.ratio.median,
                                v.ratio.min, v.ratio.max);
    }
    if (out.empty()) out = head + "\n" + rule + "\n";
    out += line + "\n";
  }
  return out;
}

}  // namespace carousel::bench
