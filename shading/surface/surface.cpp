#include "shading/surface/surface.h"

#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "core/numeric/octahedral.h"
#include "core/numeric/trigonometry.h"
#include "scene/model/opacity.h"
#include "shading/math/luminance.h"
#include "shading/surface/texture_lookup.h"

namespace carousel::shading {

namespace {

template <class T>
T interpolate(const std::vector<T>& values, const TrianglePoint& p) {
  return values[p.vertices[0]] * p.weights[0] + values[p.vertices[1]] * p.weights[1] +
         values[p.vertices[2]] * p.weights[2];
}

const std::vector<Vec2>& uv_set(const scene::Mesh& mesh, const scene::TextureUse& use) {
  return use.uv_set == 0 ? mesh.uv0 : mesh.uv1;
}

/// Stands for the mesh of a sphere.
const scene::Mesh& no_vertices() {
  static const scene::Mesh none;
  return none;
}

Vec2 on_sphere(const TrianglePoint& p) {
  const DVec3 n(from_octahedral(p.weights[1], p.weights[2]));
  return {static_cast<float>(0.5 + angle_in_turns(n.x, n.z)),
          static_cast<float>(2 * angle_in_turns(std::sqrt(n.x * n.x + n.z * n.z), n.y))};
}

Vec3 sample(const scene::Scene& scene, const TrianglePoint& p, const scene::TextureUse& use, Encoding encoding) {
  return lookup(scene, use.texture, texture_coordinates(p, use), encoding);
}

/// The cofactors of R, with its determinant's sign: R^-T up to a positive factor.
Vec3 transform_normal(const Mat3& r, bool mirrored, const Vec3& n) {
  const Vec3 m = glm::cross(r[1], r[2]) * n.x + glm::cross(r[2], r[0]) * n.y + glm::cross(r[0], r[1]) * n.z;
  return mirrored ? -m : m;
}

Vec3 normalized_or(const Vec3& v, const Vec3& fallback) {
  const float length2 = glm::dot(v, v);
  return length2 > 1e-30f && length2 < 1e30f ? v * (1.0f / std::sqrt(length2)) : fallback;
}

/// The frame of a texture, from the derivatives of the coordinates. In glTF x points along +u, and y towards the top of
/// the image, that is along -v. Empty if the coordinates do not span the triangle.
struct TextureFrame {
  Vec3 tangent, bitangent;
};
std::optional<TextureFrame> texture_frame(const TrianglePoint& p, const TriangleGeometry& g,
                                          const scene::TextureUse& use, const Vec3& n) {
  const std::vector<Vec2>& uvs = uv_set(*p.mesh, use);
  if (uvs.empty()) return std::nullopt;
  const Vec2 uv0 = transform_uv(use, uvs[p.vertices[0]]);
  const Vec2 d1 = transform_uv(use, uvs[p.vertices[1]]) - uv0, d2 = transform_uv(use, uvs[p.vertices[2]]) - uv0;
  const float determinant = d1.x * d2.y - d1.y * d2.x;
  if (determinant == 0.0f) return std::nullopt;
  const Vec3 e1(g.linear * (g.model[1] - g.model[0])), e2(g.linear * (g.model[2] - g.model[0]));
  const float sign = determinant < 0.0f ? -1.0f : 1.0f;
  const Vec3 du = (e1 * d2.y - e2 * d1.y) * sign, dv = (e2 * d1.x - e1 * d2.x) * sign;
  const Vec3 tangent = normalized_or(du - n * glm::dot(n, du), Vec3{0});
  Vec3 bitangent = glm::cross(n, tangent);
  if (glm::dot(bitangent, dv) > 0.0f) bitangent = -bitangent;
  return TextureFrame{tangent, bitangent};
}

Vec3 bend(const scene::Scene& scene, const TrianglePoint& p, const TriangleGeometry& g, const Vec3& n,
          const scene::TextureUse& use, float scale) {
  const std::optional<TextureFrame> frame = texture_frame(p, g, use, n);
  if (!frame) return n;
  const Vec3 map = sample(scene, p, use, Encoding::kLinear) * 2.0f - 1.0f;
  return normalized_or(frame->tangent * (map.x * scale) + frame->bitangent * (map.y * scale) + n * map.z, n);
}

}  // namespace

Vec2 texture_coordinates(const TrianglePoint& p, const scene::TextureUse& use) {
  const std::vector<Vec2>& uvs = uv_set(*p.mesh, use);
  if (!uvs.empty()) return transform_uv(use, interpolate(uvs, p));
  return transform_uv(use, p.mesh == &no_vertices() ? on_sphere(p) : Vec2{0, 0});
}

TrianglePoint triangle_point(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive, float u,
                             float v) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh.value];
  if (primitive >= mesh.triangle_count()) {
    return {&no_vertices(),
            &scene.materials[mesh.spheres[primitive - mesh.triangle_count()].material.value],
            {},
            {1, u, v}};
  }
  const std::uint32_t* corner = mesh.indices.data() + 3 * std::size_t{primitive};
  return {&mesh,
          &scene.materials[mesh.triangle_materials[primitive].value],
          {corner[0], corner[1], corner[2]},
          {1.0f - u - v, u, v}};
}

Vec3 base_color(const scene::Scene& scene, const TrianglePoint& p) {
  Vec3 color(p.material->base_color);
  if (p.material->base_color_texture) {
    color *= sample(scene, p, *p.material->base_color_texture, Encoding::kSrgb);
  }
  if (!p.mesh->colors.empty()) color *= Vec3(interpolate(p.mesh->colors, p));
  return color;
}

float alpha(const scene::Scene& scene, const TrianglePoint& p) {
  float alpha = p.material->base_color.a;
  if (const auto& use = p.material->base_color_texture)
    alpha *= lookup_alpha(scene, use->texture, texture_coordinates(p, *use));
  if (!p.mesh->colors.empty()) alpha *= interpolate(p.mesh->colors, p).a;
  return glm::clamp(alpha, 0.0f, 1.0f);
}

float opacity(const scene::Scene& scene, const TrianglePoint& p) {
  switch (p.material->alpha_mode) {
    case scene::AlphaMode::kMask:
      return alpha(scene, p) >= p.material->alpha_cutoff - scene::kAlphaTolerance ? 1.0f : 0.0f;
    case scene::AlphaMode::kBlend:
      return alpha(scene, p);
    case scene::AlphaMode::kOpaque:
      break;
  }
  return 1.0f;
}

MaterialPoint material_factors(const scene::Material& material) {
  return {glm::clamp(Vec3(material.base_color), Vec3{0}, Vec3{1}), glm::clamp(material.metallic, 0.0f, 1.0f),
          glm::clamp(material.roughness, 0.0f, 1.0f)};
}

MaterialPoint material_point(const scene::Scene& scene, const TrianglePoint& p) {
  MaterialPoint m{base_color(scene, p), p.material->metallic, p.material->roughness};
  if (p.material->metallic_roughness_texture) {
    const Vec3 texel = sample(scene, p, *p.material->metallic_roughness_texture, Encoding::kLinear);
    m.roughness *= texel.y;
    m.metallic *= texel.z;
  }
  // A base colour above 1 would make light out of nothing at every bounce.
  m.base_color = glm::clamp(m.base_color, Vec3{0}, Vec3{1});
  m.metallic = glm::clamp(m.metallic, 0.0f, 1.0f);
  m.roughness = glm::clamp(m.roughness, 0.0f, 1.0f);
  return m;
}

Vec3 emitted(const scene::Scene& scene, const TrianglePoint& p) {
  Vec3 radiance = p.material->emissive;
  if (p.material->emissive_texture) {
    radiance *= sample(scene, p, *p.material->emissive_texture, Encoding::kSrgb);
  }
  return radiance;
}

bool is_emissive(const scene::Material& material) {
  return !material.unlit && max_component(material.emissive) > 0.0f;
}

Vec3 shading_normal(const scene::Scene& scene, const TrianglePoint& p, const TriangleGeometry& g, const Vec3& facing,
                    bool front, const Vec3& wo) {
  const auto& map = p.material->normal_texture;
  return shading_normal(scene, p, g, facing, front, wo, map ? &*map : nullptr, p.material->normal_scale);
}

std::optional<Vec3> texture_tangent(const TrianglePoint& p, const TriangleGeometry& g, const scene::TextureUse& use,
                                    const Vec3& n) {
  const std::optional<TextureFrame> frame = texture_frame(p, g, use, n);
  if (!frame || frame->tangent == Vec3{0}) return std::nullopt;
  return frame->tangent;
}

Vec3 texture_color(const scene::Scene& scene, const TrianglePoint& p, const scene::TextureUse& use, Encoding encoding) {
  return sample(scene, p, use, encoding);
}

float texture_alpha(const scene::Scene& scene, const TrianglePoint& p, const scene::TextureUse& use) {
  return lookup_alpha(scene, use.texture, texture_coordinates(p, use));
}

Vec3 shading_normal(const scene::Scene& scene, const TrianglePoint& p, const TriangleGeometry& g, const Vec3& facing,
                    bool front, const Vec3& wo, const scene::TextureUse* map, float scale) {
  Vec3 n = front ? facing : -facing;
  if (!p.mesh->normals.empty()) {
    n = normalized_or(transform_normal(Mat3(g.linear), g.mirrored, interpolate(p.mesh->normals, p)), n);
  }
  if (map != nullptr) n = bend(scene, p, g, n, *map, scale);
  if (!front) n = -n;
  if (glm::dot(n, facing) < 0.0f) n = -n;  // normals modelled against the winding

  constexpr float kLeastCosine = 0.01f;
  const float cosine = glm::dot(n, wo);
  if (cosine < kLeastCosine) n = normalized_or(n + (kLeastCosine - cosine) * wo, facing);
  return n;
}

}  // namespace carousel::shading
