#include "shading/tracer/shade_tables.h"

#include "shading/effects/effect_rule.h"
#include "shading/surface/texture_lookup.h"

namespace carousel::shading {

namespace {

constexpr std::uint32_t kMaterialBytes = 128, kVertexBytes = 32, kTexelBytes = 4;

}  // namespace

ShadeTables::ShadeTables(const scene::Scene& scene) : scene_(scene) {
  std::uint64_t at = 0;
  for (const scene::Mesh& mesh : scene.meshes) {
    mesh_at_.push_back(at);
    at += kVertexBytes * mesh.positions.size();
  }
  at = 0;
  for (const scene::Image& image : scene.images) {
    image_at_.push_back(at);
    at += std::uint64_t{kTexelBytes} * image.width * image.height;
  }
}

void ShadeTables::reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const {
  geometry_reads(hit, point, facts);
  for (const scene::TextureUse& use : textures_read(*point.material)) lookup(point, use, facts);
}

void ShadeTables::opacity_reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const {
  geometry_reads(hit, point, facts);
  if (point.material->alpha_mode == scene::AlphaMode::kOpaque) return;
  if (const auto& use = point.material->base_color_texture) lookup(point, *use, facts);
}

void ShadeTables::geometry_reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const {
  const auto material = static_cast<std::uint64_t>(point.material - scene_.materials.data());
  facts.material.push_back({material * kMaterialBytes, kMaterialBytes});
  const std::uint32_t mesh = scene_.instances[hit.instance].mesh.value;
  if (hit.primitive < scene_.meshes[mesh].triangle_count())
    for (const std::uint32_t vertex : point.vertices) facts.vertices.push_back(this->vertex(mesh, vertex));
}

DataRead ShadeTables::vertex(std::uint32_t mesh, std::uint32_t vertex) const {
  return {mesh_at_[mesh] + std::uint64_t{vertex} * kVertexBytes, kVertexBytes};
}

void ShadeTables::lookup(const TrianglePoint& point, const scene::TextureUse& use, ShadeFacts& facts) const {
  const std::uint32_t image = scene_.textures[use.texture.value].image.value;
  std::vector<DataRead>& lookup = facts.lookups.emplace_back();
  for (const std::uint64_t texel : texels_of(scene_, use.texture, texture_coordinates(point, use)))
    lookup.push_back({image_at_[image] + texel * kTexelBytes, kTexelBytes});
}

}  // namespace carousel::shading
