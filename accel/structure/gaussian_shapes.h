#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/gaussians.h"

namespace carousel::accel {

/// The Gaussians of a scene as rays meet them. Immutable; any thread may read.
class GaussianShapes {
 public:
  explicit GaussianShapes(const scene::GaussianCloud& cloud);

  /// The hit of a ray with a Gaussian, given the hit that a test has found with one of its shapes: where along the ray
  /// its response is greatest. `instance` and `primitive` are those of its first shape, u is the square of the distance
  /// from the mean in standard deviations, and v is 0. False if that is beyond the end of the Gaussian, out of the
  /// range from `tmin` to the end of the ray, or before the shape: then the shape was left there, or the ray began
  /// within triangles. Computed in double from the ray in world space, so that it is the same with all shapes.
  bool respond(const Ray& ray, float tmin, const Hit& shape, Hit& hit) const;

  /// The share of the light from behind that the Gaussian of a hit takes: 0.99 at most, as in Kerbl et al. 2023.
  float alpha(const Hit& hit) const;
  /// Its colour for a ray of this direction, which may have any length.
  Vec3 color(const Hit& hit, const Vec3& direction) const;
  /// The degree of the harmonics that a colour is made of.
  int degree() const { return degree_; }
  /// Coefficients above degree 0 that a colour is made of. A frame that turns the direction counts as three: as many
  /// products.
  std::uint32_t color_terms() const {
    return static_cast<std::uint32_t>(scene::higher_harmonics(degree_)) + (frames_.empty() ? 0 : 3);
  }

  /// A ray that less light than this passes looks for no more.
  float opaque_below() const { return opaque_below_; }

  /// The Gaussian around which a triangle stands; absent if the shapes are spheres, whose instances they are.
  std::optional<std::uint32_t> of_triangle(std::uint32_t primitive) const {
    if (!triangles_) return std::nullopt;
    return primitive / scene::kProxyTriangles;
  }
  std::size_t count() const { return shapes_.size(); }

  /// Bytes of a Gaussian in the machine's memory beside its shapes: opacity, coefficients of its colour, and the frame
  /// of these, which stand in the record of an instance; with triangles also its mean and matrix, which the instance of
  /// a sphere has anyway.
  std::uint32_t bytes_in_instance() const { return triangles_ ? 0 : look_bytes(); }
  std::uint32_t bytes_apart() const { return triangles_ ? look_bytes() + kPlaceBytes : 0; }
  std::size_t size_bytes() const { return shapes_.size() * (bytes_in_instance() + bytes_apart()); }

 private:
  static constexpr std::uint32_t kPlaceBytes = 12 * sizeof(float), kChannels = 3;
  std::uint32_t look_bytes() const {
    return static_cast<std::uint32_t>(sizeof(float)) * (1 + kChannels * (1 + color_terms()));
  }

  struct Shape {
    DMat3 unit_from_world;  ///< the end of the Gaussian is the unit sphere
    Vec3 mean, color;
    float opacity, reach;
    std::uint32_t frame;
  };
  std::size_t number_of(const Hit& hit) const {
    return triangles_ ? hit.primitive / scene::kProxyTriangles : hit.instance;
  }

  std::vector<Shape> shapes_;
  int degree_;
  std::vector<Vec3> harmonics_;  // as GaussianCloud has them, and these
  std::vector<DMat3> frames_;
  bool triangles_;
  float opaque_below_;
};

/// Null where there are no Gaussians.
std::shared_ptr<const GaussianShapes> gaussian_shapes(const scene::GaussianCloud& cloud);

}  // namespace carousel::accel
