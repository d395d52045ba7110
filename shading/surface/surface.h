#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/types/vec.h"
#include "scene/model/scene.h"
#include "shading/bsdf/bsdf.h"
#include "shading/surface/texture_lookup.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::shading {

/// A hit triangle's entry in its mesh, and the position on the triangle. A sphere has no vertices, and so neither
/// vertex colours nor a frame for normal maps; its texture coordinates are its longitude (0 to 1 once around +y, from
/// -z by way of -x) and its latitude (0 at +y, 1 at -y), in model space.
struct TrianglePoint {
  const scene::Mesh* mesh;
  const scene::Material* material;
  std::array<std::uint32_t, 3> vertices;  ///< indices into the mesh's arrays
  std::array<float, 3> weights;           ///< barycentric; of a sphere: 1 and where on it (core/numeric/octahedral.h)
};

/// `u` weighs vertex 1 and `v` vertex 2.
TrianglePoint triangle_point(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive, float u,
                             float v);

/// Product of the base colour texture, its factor and the vertex colour. An unlit material shows this colour alone.
Vec3 base_color(const scene::Scene& scene, const TrianglePoint& point);

/// Alpha of the base colour: the product of factor, texture and vertices; 0 to 1.
float alpha(const scene::Scene& scene, const TrianglePoint& point);

/// The share of rays that stop at the point: alpha if alpha-blended, 0 or 1 if alpha-masked, 1 if opaque.
float opacity(const scene::Scene& scene, const TrianglePoint& point);

/// Base colour, metallic and roughness without textures and vertex colours.
MaterialPoint material_factors(const scene::Material& material);

/// Base colour, metallic and roughness.
MaterialPoint material_point(const scene::Scene& scene, const TrianglePoint& point);

/// Radiance of the emitting side; emits() says which sides emit.
Vec3 emitted(const scene::Scene& scene, const TrianglePoint& point);

/// True if the material emits light and takes part in lighting.
bool is_emissive(const scene::Material& material);

/// The front side emits, and the back if the material is double-sided.
inline bool emits(const scene::Material& material, bool front) {
  return front || material.double_sided;
}

/// The normal to shade with, in world space and on the side of `wo`: interpolated, bent by the normal map,
/// and turned until `wo` is above its horizon. `facing` is the geometric normal on the side of `wo`.
Vec3 shading_normal(const scene::Scene& scene, const TrianglePoint& point, const TriangleGeometry& geometry,
                    const Vec3& facing, bool front, const Vec3& wo);
/// As above, with another normal map than the material's, or with none if `map` is null.
Vec3 shading_normal(const scene::Scene& scene, const TrianglePoint& point, const TriangleGeometry& geometry,
                    const Vec3& facing, bool front, const Vec3& wo, const scene::TextureUse* map, float scale);

/// Unit direction in which a texture's u grows, at right angles to the unit normal `n`; nothing without coordinates.
std::optional<Vec3> texture_tangent(const TrianglePoint& point, const TriangleGeometry& geometry,
                                    const scene::TextureUse& use, const Vec3& n);

/// Where the point is in a texture of the material; (0, 0) without coordinates.
Vec2 texture_coordinates(const TrianglePoint& point, const scene::TextureUse& use);

/// The value of a texture of the material at the point.
Vec3 texture_color(const scene::Scene& scene, const TrianglePoint& point, const scene::TextureUse& use,
                   Encoding encoding);
float texture_alpha(const scene::Scene& scene, const TrianglePoint& point, const scene::TextureUse& use);

}  // namespace carousel::shading
