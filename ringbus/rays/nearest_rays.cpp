#include "ringbus/rays/nearest_rays.h"

#include <bit>

#include "accel/traverse/ray_check.h"

namespace carousel::ringbus {

namespace {

/// Names a ray by its bits, since the numbers of paths differ between machines: FNV-1a.
std::uint32_t name_of(const Ray& ray) {
  std::uint32_t name = 2166136261u;
  for (const float part : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z,
                           ray.tmin, ray.tmax})
    name = (name ^ std::bit_cast<std::uint32_t>(part)) * 16777619u;
  return name;
}

}  // namespace

void NearestRays::finish(RayRecord& record, HitBatch& out) {
  accel::NearestRay* const ray = accel::nearest_of(record);
  if (ray == nullptr) return accel::finish_record(record, out);
  const std::span<const Hit> hits = ray->finish();
  accel::finish_record(record, out);
  RayResult& result = out.back();
  result.light = ray->light();
  result.transmittance = ray->transmittance();
  const std::uint32_t name = name_of(result.ray);
  std::uint32_t rank = 0;
  for (const Hit& hit : hits) shared_.digest.add(hit_term(name, rank++, result.tag, hit));
  if (hits.empty()) shared_.digest.add(hit_term(name, 0, result.tag, Hit{}));
  if (sink_ != nullptr) sink_->add(result, hits);
}

}  // namespace carousel::ringbus
