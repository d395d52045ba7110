#include "shading/raster/first_hits.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include <glm/matrix.hpp>

#include "scene/model/opacity.h"
#include "shading/camera/camera_rays.h"
#include "shading/camera/pixel_order.h"
#include "shading/math/sampler.h"
#include "shading/raster/edge_functions.h"
#include "shading/raster/screen.h"

namespace carousel::shading {

namespace {

constexpr std::uint32_t kBinSide = PixelOrder::kTile;  // pixels, along each side

using TriangleRef = FirstHits::Triangle;

DVec3 placed(const scene::Affine& m, const Vec3& p) {
  return DMat3(m.linear) * DVec3(p) + DVec3(m.translation);
}

std::array<DVec3, 3> world_triangle(const scene::Scene& scene, TriangleRef ref) {
  const scene::Instance& instance = scene.instances[ref.instance];
  const scene::Mesh& mesh = scene.meshes[instance.mesh.value];
  const std::uint32_t* v = &mesh.indices[std::size_t{3} * ref.primitive];
  const scene::Affine& m = instance.world_from_model;
  return {placed(m, mesh.positions[v[0]]), placed(m, mesh.positions[v[1]]), placed(m, mesh.positions[v[2]])};
}

std::array<DVec3, 8> world_box(const scene::Sphere& sphere, const scene::Affine& m) {
  std::array<DVec3, 8> out;
  for (std::size_t i = 0; i < 8; ++i) {
    const DVec3 corner(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    const DVec3 model = DVec3(sphere.center) + 1.000001 * static_cast<double>(sphere.radius) * corner;
    out[i] = DMat3(m.linear) * model + DVec3(m.translation);
  }
  return out;
}

class Rasterizer {
 public:
  Rasterizer(const scene::Scene& scene, const scene::Camera& camera, const CameraRays& rays, const Sampler& sampler,
             const Screen& screen, std::uint32_t samples, const RayFlags& ray_flags, const AnyHit* any_hit,
             bool keeps_tiles)
      : scene_(scene),
        rays_(rays),
        sampler_(sampler),
        screen_(screen),
        opacity_(scene),
        ray_flags_(ray_flags),
        any_hit_(opacity_.any() && !ray_flags.force_opaque ? any_hit : nullptr),
        one_eye_(camera.projection == scene::Camera::Projection::kPerspective),
        tiles_across_((screen.width() + kBinSide - 1) / kBinSide),
        bins_(std::size_t{tiles_across_} * ((screen.height() + kBinSide - 1) / kBinSide)) {
    const std::size_t pixels = std::size_t{screen.width()} * screen.height();
    out_.samples = samples;
    out_.hits.resize(pixels * samples);
    out_.left_to_rays.resize(pixels);
    if (keeps_tiles) out_.tiles.resize(bins_.size());
  }

  FirstHits run(Executor& executor) {
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) bin_instance(i);
    std::vector<FirstHits::Counts> counts(bins_.size());
    executor.parallel_for(bins_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t tile = begin; tile < end; ++tile) draw(static_cast<std::uint32_t>(tile), counts[tile]);
    });
    for (const FirstHits::Counts& c : counts) out_.counts += c;
    return std::move(out_);
  }

 private:
  void bin_instance(std::uint32_t index) {
    const scene::Instance& instance = scene_.instances[index];
    const scene::Mesh& mesh = scene_.meshes[instance.mesh.value];
    for (const scene::Sphere& sphere : mesh.spheres) {
      const PixelBox box = screen_.bounds(world_box(sphere, instance.world_from_model));
      for (std::uint32_t y = box.y0; y < box.y1; ++y) {
        std::fill_n(&out_.left_to_rays[std::size_t{y} * screen_.width() + box.x0], box.empty() ? 0 : box.x1 - box.x0,
                    1);
      }
    }
    const auto triangles = static_cast<std::uint32_t>(mesh.triangle_count());
    out_.counts.triangles += triangles;
    for (std::uint32_t primitive = 0; primitive < triangles; ++primitive) {
      const TriangleRef ref{index, primitive};
      const PixelBox box = screen_.bounds(world_triangle(scene_, ref));
      if (box.empty()) continue;
      for (std::uint32_t y = box.y0 / kBinSide; y <= (box.y1 - 1) / kBinSide; ++y) {
        for (std::uint32_t x = box.x0 / kBinSide; x <= (box.x1 - 1) / kBinSide; ++x) {
          bins_[std::size_t{y} * tiles_across_ + x].push_back(ref);
          ++out_.counts.binned;
        }
      }
    }
  }

  void draw(std::uint32_t tile, FirstHits::Counts& counts) {
    const std::uint32_t x0 = tile % tiles_across_ * kBinSide, y0 = tile / tiles_across_ * kBinSide;
    const PixelBox area{x0, y0, std::min(x0 + kBinSide, screen_.width()), std::min(y0 + kBinSide, screen_.height())};
    std::vector<Ray> rays;  // rays of the tile, row by row, the samples of a pixel together
    for (std::uint32_t y = area.y0; y < area.y1; ++y) {
      for (std::uint32_t x = area.x0; x < area.x1; ++x) {
        for (std::uint32_t s = 0; s < out_.samples; ++s)
          rays.push_back(rays_.ray(x, y, sampler_.camera(y * screen_.width() + x, s)));
      }
    }
    for (const TriangleRef ref : bins_[tile]) draw_triangle(ref, area, rays, counts);
    for (std::uint32_t y = area.y0; y < area.y1; ++y) {
      for (std::uint32_t x = area.x0; x < area.x1; ++x) count_pixel(y * screen_.width() + x, counts);
    }
    std::vector<TriangleRef> triangles = std::exchange(bins_[tile], {});
    if (!out_.tiles.empty()) out_.tiles[tile] = {std::move(triangles), counts.tested, counts.any_hit_calls};
  }

  void draw_triangle(TriangleRef ref, const PixelBox& area, const std::vector<Ray>& rays, FirstHits::Counts& counts) {
    const std::array<DVec3, 3> world = world_triangle(scene_, ref);
    const PixelBox box = screen_.bounds(world);
    const scene::Mesh& mesh = scene_.meshes[scene_.instances[ref.instance].mesh.value];
    // A mirroring transform swaps the sides in world space; the mesh says which one is the front.
    const bool mirrored = glm::determinant(DMat3(scene_.instances[ref.instance].world_from_model.linear)) < 0;
    const bool passes = any_hit_ != nullptr && opacity_.may_be_non_opaque(mesh, ref.primitive);
    const auto edges_from = [&](const Vec3& eye) {
      return EdgeFunctions({world[0] - DVec3(eye), world[1] - DVec3(eye), world[2] - DVec3(eye)});
    };
    EdgeFunctions edges = edges_from(rays[0].origin);
    for (std::uint32_t y = std::max(box.y0, area.y0); y < std::min(box.y1, area.y1); ++y) {
      for (std::uint32_t x = std::max(box.x0, area.x0); x < std::min(box.x1, area.x1); ++x) {
        const std::size_t first = std::size_t{(y - area.y0) * (area.x1 - area.x0) + (x - area.x0)} * out_.samples;
        Hit* hits = &out_.hits[(std::size_t{y} * screen_.width() + x) * out_.samples];
        for (std::uint32_t s = 0; s < out_.samples; ++s) {
          const Ray& ray = rays[first + s];
          if (!one_eye_) edges = edges_from(ray.origin);
          ++counts.tested;
          const auto crossing = edges.cross(DVec3(ray.direction));
          if (!crossing) continue;
          if (ray_flags_.cull == (crossing->front == mirrored ? RayFlags::Cull::kBack : RayFlags::Cull::kFront))
            continue;
          const Hit hit{static_cast<float>(crossing->t), static_cast<float>(crossing->u),
                        static_cast<float>(crossing->v), ref.instance, ref.primitive};
          if (!(hit.t >= ray.tmin && hit.t <= ray.tmax)) continue;
          const Hit& best = hits[s];
          if (std::tie(best.t, best.instance, best.primitive) < std::tie(hit.t, hit.instance, hit.primitive)) continue;
          if (passes) {
            ++counts.any_hit_calls;
            if (!any_hit_->accepts(ray, hit.instance, hit.primitive, hit.u, hit.v)) continue;
          }
          hits[s] = hit;
        }
      }
    }
  }

  void count_pixel(std::uint32_t pixel, FirstHits::Counts& counts) const {
    for (std::uint32_t s = 0; s < out_.samples; ++s) {
      const Hit* hit = out_.at(pixel, s);
      ++(hit == nullptr ? counts.left_to_rays : hit->valid() ? counts.hits : counts.misses);
    }
  }

  const scene::Scene& scene_;
  const CameraRays& rays_;
  const Sampler& sampler_;
  const Screen& screen_;
  const scene::Opacity opacity_;
  const RayFlags ray_flags_;
  const AnyHit* any_hit_;
  const bool one_eye_;
  const std::uint32_t tiles_across_;
  std::vector<std::vector<TriangleRef>> bins_;  // by tile
  FirstHits out_;
};

}  // namespace

FirstHits rasterize_first_hits(const scene::Scene& scene, const Config& config, const AnyHit* any_hit,
                               Executor& executor) {
  const auto width = static_cast<std::uint32_t>(config.image.width),
             height = static_cast<std::uint32_t>(config.image.height);
  const auto samples = static_cast<std::uint32_t>(config.image.samples);
  const scene::Camera& camera = scene.cameras.at(static_cast<std::size_t>(config.scene.camera));
  const CameraRays rays(camera, config.camera, width, height);
  const Sampler sampler(static_cast<std::uint64_t>(config.image.seed), samples);
  const Screen screen(camera, rays, width, height);
  return Rasterizer(scene, camera, rays, sampler, screen, samples, config.shading.camera_rays, any_hit,
                    config.raster.time == RasterConfig::Time::kCycles)
      .run(executor);
}

}  // namespace carousel::shading
