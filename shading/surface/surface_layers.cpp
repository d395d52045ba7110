#include "shading/surface/surface_layers.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/ggx.h"
#include "shading/bsdf/iridescence.h"
#include "shading/math/trigonometry.h"
#include "shading/surface/material_properties.h"

namespace carousel::shading {

namespace {

using Use = std::optional<scene::TextureUse>;

Vec3 linear(const SurfaceHit& hit, const Use& use) {
  return use ? texture_color(hit.scene, hit.point, *use, Encoding::kLinear) : Vec3{1};
}
Vec3 srgb(const SurfaceHit& hit, const Use& use) {
  return use ? texture_color(hit.scene, hit.point, *use, Encoding::kSrgb) : Vec3{1};
}
float alpha_of(const SurfaceHit& hit, const Use& use) {
  return use ? texture_alpha(hit.scene, hit.point, *use) : 1.0f;
}
float unit(float x) {
  return std::clamp(x, 0.0f, 1.0f);
}

/// The B channel of the material's texture of direction and strength.
float grain_strength(const SurfaceHit& hit) {
  const auto& a = hit.point.material->anisotropy;
  return a.strength > 0.0f ? unit(a.strength * linear(hit, a.texture).z) : 0.0f;
}

}  // namespace

GlassTables glass_tables(const scene::Material& material) {
  if (!refracts(material)) return {};
  return {&GlassAlbedo::of(material.ior), &GlassAlbedo::of(1.0f / material.ior)};
}

ShadingBasis grain_frame(const SurfaceHit& hit, const Vec3& n) {
  const scene::Material& m = *hit.point.material;
  const auto& a = m.anisotropy;
  if (!(a.strength > 0.0f)) return ShadingBasis(n);
  const scene::TextureUse plain{};
  const scene::TextureUse& use = a.texture ? *a.texture : m.normal_texture ? *m.normal_texture : plain;
  const std::optional<Vec3> tangent = texture_tangent(hit.point, hit.geometry, use, n);
  if (!tangent) return ShadingBasis(n);
  Vec2 along{1, 0};
  if (a.texture) {
    const Vec3 texel = linear(hit, a.texture);
    along = {texel.x * 2.0f - 1.0f, texel.y * 2.0f - 1.0f};
  }
  const SinCos turn = sin_cos_turns(a.rotation * 0.159154943f);
  const Vec2 turned{turn.cos * along.x - turn.sin * along.y, turn.sin * along.x + turn.cos * along.y};
  const Vec3 direction = *tangent * turned.x + glm::cross(n, *tangent) * turned.y;
  const float length2 = glm::dot(direction, direction);
  return length2 > 1e-12f ? ShadingBasis(n, direction * (1.0f / std::sqrt(length2))) : ShadingBasis(n);
}

InterfacePoint interface_point(const SurfaceHit& hit, const MaterialPoint& material, const GlassTables& glass,
                               float cosine) {
  const scene::Material& m = *hit.point.material;
  InterfacePoint out;
  out.material = material;
  const float alpha = ggx_alpha(material.roughness), strength = grain_strength(hit);
  out.alpha = {alpha + (1.0f - alpha) * strength * strength, alpha};

  const float weight = unit(m.specular.weight * alpha_of(hit, m.specular.texture));
  const float f0 = m.ior > 0.0f ? f0_of_eta(m.ior) : 1.0f;
  const Vec3 full_f0 = glm::min(m.specular.color * srgb(hit, m.specular.color_texture) * f0, Vec3{1});
  out.dielectric_f0 = full_f0 * weight;
  out.dielectric_f90 = weight;
  out.metal_f0 = material.base_color;
  if (const auto& film = m.iridescence; film.weight > 0.0f) {
    const float share = unit(film.weight * linear(hit, film.texture).x);
    const float thickness =
        film.thickness_texture ? glm::mix(film.thickness_min, film.thickness_max, linear(hit, film.thickness_texture).y)
                               : film.thickness_max;
    const auto under_film = [&](const Vec3& base) {
      return f0_of_reflectance(film_reflectance(cosine, film.ior, thickness, base), cosine);
    };
    out.dielectric_f0 = glm::mix(out.dielectric_f0, under_film(full_f0) * weight, share);
    out.metal_f0 = glm::mix(out.metal_f0, under_film(out.metal_f0), share);
  }
  if (m.transmission.weight > 0.0f)
    out.transmission = unit(m.transmission.weight * linear(hit, m.transmission.texture).x);
  if (glass.outside != nullptr) {
    out.glass = hit.front ? glass.outside : glass.inside;
    out.eta = hit.front ? m.ior : 1.0f / m.ior;
  }
  return out;
}

LayerPoint layer_point(const SurfaceHit& hit, const ShadingBasis& frame, const GlassTables& glass) {
  LayerPoint out;
  if (!hit.front && glass.outside != nullptr) return out;
  const scene::Material& m = *hit.point.material;
  const auto roughness = [&](float r) { return hit.blurred ? widened_roughness(unit(r)) : unit(r); };
  if (const auto& coat = m.clearcoat; coat.weight > 0.0f) {
    out.coat = unit(coat.weight * linear(hit, coat.texture).x);
    out.coat_roughness = roughness(coat.roughness * linear(hit, coat.roughness_texture).y);
    if (coat.normal_texture || m.normal_texture) {
      const scene::TextureUse* map = coat.normal_texture ? &*coat.normal_texture : nullptr;
      out.coat_normal = frame.to_local(
          shading_normal(hit.scene, hit.point, hit.geometry, hit.facing, hit.front, hit.wo, map, coat.normal_scale));
    }
  }
  if (const auto& sheen = m.sheen; sheen.color != Vec3{0}) {
    out.sheen = glm::clamp(sheen.color * srgb(hit, sheen.color_texture), Vec3{0}, Vec3{1});
    out.sheen_roughness = roughness(sheen.roughness * alpha_of(hit, sheen.roughness_texture));
  }
  return out;
}

}  // namespace carousel::shading
