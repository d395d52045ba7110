#include <cmath>
#include <initializer_list>
#include <optional>

#include <fmt/format.h>

#include "shading/effects/effect_rule.h"
#include "shading/effects/secondary_rays.h"
#include "shading/math/luminance.h"
#include "shading/path/volume_stack.h"
#include "shading/surface/material_properties.h"
#include "shading/surface/surface.h"

namespace carousel::shading {

namespace {

using scene::AlphaMode;
using scene::Material;
using scene::Mesh;
using scene::PunctualLight;
using scene::Scene;
using Reads = std::vector<scene::TextureUse>;
using Lookup = std::optional<scene::TextureUse>;
using Kind = PunctualLight::Kind;

constexpr std::uint32_t u32(auto value) {
  return static_cast<std::uint32_t>(value);
}

void add(Reads& reads, std::initializer_list<const Lookup*> uses) {
  for (const Lookup* use : uses)
    if (*use) reads.push_back(**use);
}

bool reflects(const Material& m) {
  return m.metallic > 0 || m.specular.weight > 0;
}
bool has_clearcoat(const Material& m) {
  return m.clearcoat.weight > 0;
}
bool has_sheen(const Material& m) {
  return max_component(m.sheen.color) > 0;
}
bool is_iridescent(const Material& m) {
  return m.iridescence.weight > 0;
}
bool is_anisotropic(const Material& m) {
  return m.anisotropy.strength > 0;
}

template <AlphaMode kMode>
bool has_alpha(const Material& m) {
  return m.alpha_mode == kMode;
}
template <AlphaMode kMode>
void make_opaque(Material& m) {
  if (m.alpha_mode == kMode) m.alpha_mode = AlphaMode::kOpaque;
}
std::uint32_t any_hit_cycles(const Config& config) {
  const bool by_shader = config.testers.any_hit == TestersConfig::AnyHit::kShader;
  return u32(by_shader ? config.shading.cycles_per_any_hit : config.testers.units[UnitKind::kAnyHit].interval_cycles);
}

template <Kind kKind>
bool shines(const PunctualLight& light) {
  return light.kind == kKind && max_component(light.intensity) > 0;
}
template <Kind kKind>
void remove_lights(Scene& scene) {
  std::erase_if(scene.lights, [](const PunctualLight& light) { return light.kind == kKind; });
}

Need environment_map(const PlanInput& in) {
  const scene::SkyMap& map = in.scene.sky.map;
  if (map.empty()) return {};
  if (!is_lit(map)) return {false, fmt::format("the map {} is black", map.name)};
  return {true, fmt::format("the map {} of {} x {}", map.name, map.width, map.height)};
}

Need need_if(bool called_for, const char* caller) {
  return called_for ? Need{true, caller} : Need{};
}

constexpr std::array<EffectRule, kEffects> kRules{{
    {.effect = Effect::kBaseColorTexture,
     .material = [](const Material& m) { return m.base_color_texture.has_value(); },
     .unlit_too = true,
     .disable_in_material = [](Material& m) { m.base_color_texture.reset(); },
     .shader = kTextures,
     .textures = [](const Material& m, Reads& reads) { add(reads, {&m.base_color_texture}); },
     .texture_reads = 1,
     .products = 3},
    {.effect = Effect::kMetallicRoughnessTexture,
     .material = [](const Material& m) { return m.metallic_roughness_texture.has_value(); },
     .disable_in_material = [](Material& m) { m.metallic_roughness_texture.reset(); },
     .shader = kTextures,
     .textures = [](const Material& m, Reads& reads) { add(reads, {&m.metallic_roughness_texture}); },
     .texture_reads = 1,
     .products = 2},
    {.effect = Effect::kNormalMap,
     .material = [](const Material& m) { return m.normal_texture || (has_clearcoat(m) && m.clearcoat.normal_texture); },
     .disable_in_material =
         [](Material& m) {
           m.normal_texture.reset();
           m.clearcoat.normal_texture.reset();
         },
     .shader = kTextures,
     .textures =
         [](const Material& m, Reads& reads) {
           add(reads, {&m.normal_texture});
           if (has_clearcoat(m)) add(reads, {&m.clearcoat.normal_texture});
         },
     .texture_reads = 1,
     .products = 80},
    {.effect = Effect::kVertexColor,
     .mesh = [](const Mesh& mesh) { return !mesh.colors.empty(); },
     .disable_in_scene =
         [](Scene& scene) {
           for (Mesh& mesh : scene.meshes) mesh.colors.clear();
         },
     .shader = kTextures,
     .products = 15},
    {.effect = Effect::kReflection,
     .material = reflects,
     .disable_in_material =
         [](Material& m) {
           m.metallic = 0;
           m.specular = {.weight = 0, .color = Vec3{1}, .texture = {}, .color_texture = {}};
         }},
    {.effect = Effect::kMirror,
     .material = [](const Material& m) { return reflects(m) && m.roughness <= kMirrorRoughness; },
     .disable_in_material =
         [](Material& m) {
           if (m.roughness <= kMirrorRoughness) m.roughness = 0.3f;
         }},
    {.effect = Effect::kEmission,
     .material = is_emissive,
     .disable_in_material =
         [](Material& m) {
           m.emissive = Vec3{0};
           m.emissive_texture.reset();
         },
     .textures = [](const Material& m, Reads& reads) { add(reads, {&m.emissive_texture}); },
     .texture_reads = 1},
    {.effect = Effect::kTransmission,
     .material = [](const Material& m) { return m.transmission.weight > 0; },
     .dielectric_only = true,
     .disable_in_material = [](Material& m) { m.transmission = {}; },
     .shader = kBoundary | kTransmission,
     .textures =
         [](const Material& m, Reads& reads) {
           if (m.transmission.weight > 0) add(reads, {&m.transmission.texture});
         },
     .texture_reads = 1,
     .products = 54},
    {.effect = Effect::kRefraction,
     .material = refracts,
     .disable_in_material = [](Material& m) { m.volume.thickness = 0; },
     .products = 130},
    {.effect = Effect::kVolume,
     .material = absorbs,
     .disable_in_material = [](Material& m) { m.volume.attenuation_distance = INFINITY; },
     .products = 30,
     .path_state_bytes = [](std::uint32_t) { return u32(sizeof(VolumeStack)); }},
    {.effect = Effect::kIor,
     .material = [](const Material& m) { return m.ior != 1.5f; },
     .dielectric_only = true,
     .disable_in_material = [](Material& m) { m.ior = 1.5f; },
     .shader = kBoundary,
     .products = 10},
    {.effect = Effect::kSpecular,
     .material =
         [](const Material& m) {
           const auto& s = m.specular;
           return s.weight != 1 || s.color != Vec3{1} || s.texture || s.color_texture;
         },
     .dielectric_only = true,
     .disable_in_material = [](Material& m) { m.specular = {}; },
     .shader = kBoundary,
     .textures =
         [](const Material& m, Reads& reads) {
           add(reads, {&m.specular.texture, &m.specular.color_texture});
         },
     .texture_reads = 2,
     .products = 40},
    {.effect = Effect::kClearcoat,
     .material = has_clearcoat,
     .disable_in_material = [](Material& m) { m.clearcoat = {}; },
     .shader = kLayers,
     .textures =
         [](const Material& m, Reads& reads) {
           if (has_clearcoat(m)) add(reads, {&m.clearcoat.texture, &m.clearcoat.roughness_texture});
         },
     .texture_reads = 2,
     .products = 214,
     .evaluated_without = true},
    {.effect = Effect::kSheen,
     .material = has_sheen,
     .disable_in_material = [](Material& m) { m.sheen = {}; },
     .shader = kLayers,
     .textures =
         [](const Material& m, Reads& reads) {
           if (has_sheen(m)) add(reads, {&m.sheen.color_texture, &m.sheen.roughness_texture});
         },
     .texture_reads = 2,
     .products = 242,
     .evaluated_without = true},
    {.effect = Effect::kIridescence,
     .material = is_iridescent,
     .disable_in_material = [](Material& m) { m.iridescence = {}; },
     .shader = kBoundary,
     .textures =
         [](const Material& m, Reads& reads) {
           if (is_iridescent(m)) add(reads, {&m.iridescence.texture, &m.iridescence.thickness_texture});
         },
     .texture_reads = 2,
     .products = 630},
    {.effect = Effect::kAnisotropy,
     .material = is_anisotropic,
     .disable_in_material = [](Material& m) { m.anisotropy = {}; },
     .shader = kBoundary,
     .textures =
         [](const Material& m, Reads& reads) {
           if (is_anisotropic(m)) add(reads, {&m.anisotropy.texture});
         },
     .texture_reads = 1,
     .products = 5264},
    {.effect = Effect::kAlphaMask,
     .material = has_alpha<AlphaMode::kMask>,
     .unlit_too = true,
     .disable_in_material = make_opaque<AlphaMode::kMask>,
     .texture_reads = 1,
     .cycles_per_hit = any_hit_cycles},
    {.effect = Effect::kAlphaBlend,
     .material = has_alpha<AlphaMode::kBlend>,
     .unlit_too = true,
     .disable_in_material = make_opaque<AlphaMode::kBlend>,
     .texture_reads = 1,
     .cycles_per_hit = any_hit_cycles},
    {.effect = Effect::kDoubleSided,
     // Back sides are drawn in any case; only their emission depends on the material.
     .material = [](const Material& m) { return m.double_sided && is_emissive(m); },
     .disable_in_material = [](Material& m) { m.double_sided = false; }},
    {.effect = Effect::kUnlit,
     .material = [](const Material& m) { return m.unlit; },
     .unlit_too = true,
     .disable_in_material = [](Material& m) { m.unlit = false; }},
    {.effect = Effect::kPointLights, .light = shines<Kind::kPoint>, .disable_in_scene = remove_lights<Kind::kPoint>},
    {.effect = Effect::kSpotLights, .light = shines<Kind::kSpot>, .disable_in_scene = remove_lights<Kind::kSpot>},
    {.effect = Effect::kDirectionalLights,
     .light = shines<Kind::kDirectional>,
     .disable_in_scene = remove_lights<Kind::kDirectional>},
    {.effect = Effect::kAreaLights, .material = is_emissive},
    {.effect = Effect::kSky,
     .scene = [](const PlanInput& in) { return need_if(max_component(in.scene.sky.radiance) > 0, "sky"); },
     .disable_in_scene = [](Scene& scene) { scene.sky.radiance = Vec3{0}; }},
    // A surface draws a direction from the map (32 products) and looks up the light that comes from there: its place on
    // the map (48), the filter (18), density and weight (6). A ray that leaves the scene looks it up alone, and finds
    // the density for its weight (11).
    {.effect = Effect::kEnvironmentMap,
     .scene = environment_map,
     .disable_in_scene = [](Scene& scene) { scene.sky.map = {}; },
     .texture_reads = 1,
     .products = 104,
     .miss_products = 77},
    {.effect = Effect::kDepthOfField,
     .scene = [](const PlanInput& in) { return need_if(in.config.camera.aperture > 0, "camera.aperture"); }},
    {.effect = Effect::kShadowRays,
     .scene = shadow_rays,
     .rays_per_path = [](std::uint32_t depth) { return depth; },
     .path_state_bytes = [](std::uint32_t depth) { return depth * u32(sizeof(Vec3)); }},
    {.effect = Effect::kBounceRays,
     .scene = bounce_rays,
     .rays_per_path = [](std::uint32_t depth) { return depth - 1; }},
    {.effect = Effect::kTransparentShadows,
     .scene = transparent_shadows,
     .texture_reads = 2,
     .rays_per_path = [](std::uint32_t depth) { return depth * (depth - 1) / 2; }},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kEffects; ++i)
    if (kRules[i].effect != static_cast<Effect>(i)) return false;
  return true;
}
static_assert(in_order(), "one row an effect, in the order of the enum");

}  // namespace

std::span<const EffectRule, kEffects> effect_rules() {
  return kRules;
}

const EffectRule& rule_of(Effect effect) {
  return kRules[static_cast<std::size_t>(effect)];
}

}  // namespace carousel::shading
