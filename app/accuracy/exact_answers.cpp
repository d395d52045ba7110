#include "app/accuracy/exact_answers.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "accel/traverse/reference_tracer.h"
#include "core/statistics/intersection_counts.h"

namespace carousel::app {

HitList trace(const accel::Accel& accel, const RayBatch& rays) {
  HitBatch results;
  results.reserve(rays.size());
  IntersectionCounts counts;
  accel::trace_depth_first(accel, rays, results, counts);
  HitList hits;
  hits.reserve(results.size());
  for (const RayResult& result : results) hits.push_back(result.hit);
  return hits;
}

std::vector<accel::ExactHit> exact_answers(const accel::ExactReference& reference, const RayBatch& rays) {
  std::vector<accel::ExactHit> out(rays.size());
  tbb::parallel_for(std::size_t{0}, rays.size(),
                    [&](std::size_t i) { out[i] = reference.closest(rays[i].ray, rays[i].tag.flags); });
  return out;
}

namespace {

bool same_primitive(const Hit& a, const Hit& b) {
  return a.instance == b.instance && (!a.valid() || a.primitive == b.primitive);
}

}  // namespace

std::uint64_t settle_opacity(const accel::Accel& accel, const RayBatch& rays, const std::vector<accel::ExactHit>& exact,
                             HitList& hits) {
  RayBatch others;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (same_primitive(hits[i], exact[i].hit)) continue;
    others.push_back(rays[i]);
    places.push_back(i);
  }
  const HitList again = trace(accel, others);
  std::uint64_t settled = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    settled += !same_primitive(again[k], hits[places[k]]);
    hits[places[k]] = again[k];
  }
  return settled;
}

report::HitErrors compare(const RayBatch& rays, const HitList& hits, const std::vector<accel::ExactHit>& exact) {
  report::HitErrors errors;
  errors.rays = rays.size();
  std::vector<double> ulps;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    const accel::ExactHit& truth = exact[i];
    errors.missed += truth.hit.valid() && !hit.valid();
    errors.extra += hit.valid() && !truth.hit.valid();
    if (!hit.valid() || !truth.hit.valid() || rays[i].tag.kind == RayKind::kShadow) continue;
    if (!same_primitive(hit, truth.hit)) {
      errors.other += !truth.tie;
      continue;
    }
    const double ulp = std::nextafter(truth.hit.t, kInfinity) - truth.hit.t;
    ulps.push_back(std::abs(double(hit.t) - truth.t) / ulp);
  }
  if (ulps.empty()) return errors;
  std::sort(ulps.begin(), ulps.end());
  errors.ulp_median = ulps[ulps.size() / 2];
  errors.ulp_p99 = ulps[ulps.size() * 99 / 100];
  errors.ulp_max = ulps.back();
  return errors;
}

}  // namespace carousel::app
