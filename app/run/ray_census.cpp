#include "app/run/ray_census.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

#include "accel/traverse/reference_tracer.h"

namespace carousel::app {

std::uint64_t RayCensus::one_in(std::uint64_t rays) {
  constexpr std::uint64_t kEnough = 32768;
  return std::bit_ceil(std::max<std::uint64_t>(1, (rays + kEnough - 1) / kEnough));
}

/// Rays are told apart by their bits, so the choice is the same in whatever order and by whichever worker they are
/// shaded.
bool RayCensus::keeps(const Ray& ray) const {
  std::uint64_t bits = 0;
  for (const float x : {ray.direction.x, ray.direction.y, ray.direction.z, ray.origin.x, ray.origin.y, ray.origin.z})
    bits = (bits ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ull;
  return (bits >> 32 & (one_in_ - 1)) == 0;
}

Workload::Generated RayCensus::generate(WorkerId worker, std::size_t max_rays, RayBatch& out) {
  const std::size_t before = out.size();
  const Generated made = inner_.generate(worker, max_rays, out);
  Worker& own = workers_[worker.value];
  for (std::size_t i = before; i < out.size(); ++i) {
    BounceCounts& counts = own.at(out[i].tag.bounce);
    ++(out[i].tag.kind == RayKind::kShadow ? counts.shadow_begun : counts.begun);
  }
  return made;
}

void RayCensus::shade(WorkerId worker, const HitBatch& completed, RayBatch& out) {
  Worker& own = workers_[worker.value];
  for (const RayResult& ray : completed) {
    BounceCounts& counts = own.at(ray.tag.bounce);
    if (ray.tag.kind == RayKind::kShadow) {
      ++counts.shadow;
      ++(ray.hit.valid() ? counts.occluded : counts.lit);
    } else {
      ++counts.rays;
      ++(ray.hit.valid() ? counts.hit : counts.escaped);
    }
    if (keeps(ray.ray)) own.kept.push_back({ray.ray, ray.tag});
  }
  const std::size_t before = out.size();
  inner_.shade(worker, completed, out);
  for (std::size_t i = before; i < out.size(); ++i) {
    const RayTag& tag = out[i].tag;
    if (tag.kind == RayKind::kShadow)
      own.at(tag.bounce).passed += tag.index > 0;
    else if (tag.bounce > 0)
      ++own.at(tag.bounce - std::size_t{1}).went_on;
  }
}

void RayCensus::join(ringbus::Transport& ranks) {
  std::string bounces, kept;
  const auto append = [](std::string& to, const auto& values) {
    static_assert(std::is_trivially_copyable_v<std::decay_t<decltype(values[0])>>);
    to.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  Worker sum;
  for (Worker& worker : workers_) {
    for (std::size_t b = 0; b < worker.bounces.size(); ++b) sum.at(b) += worker.bounces[b];
    append(kept, worker.kept);
    worker = {};
  }
  append(bounces, sum.bounces);
  Worker& all = workers_.front();
  for (const std::string& bytes : ranks.gather(bounces)) {
    std::vector<BounceCounts> counts(bytes.size() / sizeof(BounceCounts));
    std::memcpy(counts.data(), bytes.data(), bytes.size());
    for (std::size_t b = 0; b < counts.size(); ++b) all.at(b) += counts[b];
  }
  for (const std::string& bytes : ranks.gather(kept)) {
    const std::size_t before = all.kept.size();
    all.kept.resize(before + bytes.size() / sizeof(RayRequest));
    std::memcpy(all.kept.data() + before, bytes.data(), bytes.size());
  }
}

std::vector<report::RayBounce> RayCensus::by_bounce() const {
  std::vector<report::RayBounce> out;
  for (const Worker& worker : workers_)
    for (std::size_t bounce = 0; bounce < worker.bounces.size(); ++bounce) {
      if (out.size() <= bounce) out.push_back({bounce, {}});
      out[bounce].counts += worker.bounces[bounce];
    }
  return out;
}

report::DepthFirst RayCensus::depth_first(const accel::Accel& accel) const {
  report::DepthFirst out{0, one_in_, {}};
  HitBatch hits;
  for (const Worker& worker : workers_) {
    out.rays += worker.kept.size();
    hits.clear();
    accel::trace_depth_first(accel, worker.kept, hits, out.counts);
  }
  return out;
}

}  // namespace carousel::app
