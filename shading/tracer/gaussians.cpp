// Light of a camera ray that has met Gaussians: the ray's record has blended them on its way.
#include <algorithm>

#include "core/numeric/exponential.h"
#include "shading/tracer/path_tracer-inl.h"

namespace carousel::shading {

namespace {

// sRGB (IEC 61966-2-1), also above 1.
float to_display(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * pow_float(linear, 1 / 2.4f) - 0.055f;
}
float to_linear(float display) {
  return display <= 0.04045f ? display / 12.92f : pow_float((display + 0.055f) / 1.055f, 2.4f);
}

}  // namespace

/// Colours for a display are blended as they are and converted then, as KHR_gaussian_splatting says.
void PathTracer::shade_gaussians(const RayResult& result, Worker& worker) {
  Vec3 seen = scene_.sky.radiance;
  if (lights_.has_sky()) seen += lights_.sky(result.ray.direction).radiance;
  if (result.hit.valid()) {
    const auto blended = [&](float behind, int c) { return result.light[c] + result.transmittance * behind; };
    for (int c = 0; c < 3; ++c)
      seen[c] = scene_.gaussians.display ? to_linear(blended(to_display(seen[c]), c)) : blended(seen[c], c);
  }
  PathState& path = pool_.state(result.tag.path);
  add_radiance(path, path.throughput * seen, worker);
}

}  // namespace carousel::shading
