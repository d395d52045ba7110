#include "shading/effects_plan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "shading/luminance.h"
#include "shading/path_pool.h"
#include "shading/surface.h"

namespace carousel::shading {

namespace {

using scene::AlphaMode;
using scene::Material;

constexpr float kMirrorRoughness = 0.0316f;   // squared this is the least alpha of the GGX lobe
constexpr float kStraight = 0.005f;           // an index this near to 1 does not refract

bool bright(const Vec3& color) {
  return color.x > 0 || color.y > 0 || color.z > 0;
}

/// Which materials triangles of instances have.
std::vector<bool> reached_materials(const scene::Scene& scene) {
  std::vector<bool> reached(scene.materials.size(), false), seen(scene.meshes.size(), false);
  for (const scene::Instance& instance : scene.instances) {
    if (seen[instance.mesh.value]) continue;
    seen[instance.mesh.value] = true;
    for (const MaterialId id : scene.meshes[instance.mesh.value].triangle_materials) reached[id.value] = true;
    for (const scene::Sphere& sphere : scene.meshes[instance.mesh.value].spheres) reached[sphere.material.value] = true;
  }
  return reached;
}

/// Whether a material calls for an effect; false for effects that are none of a material's.
bool material_calls(const Material& m, Effect effect) {
  switch (effect) {
    case Effect::kBaseColorTexture:
      return m.base_color_texture.has_value();
    case Effect::kUnlit:
      return m.unlit;
    case Effect::kAlphaMask:
      return m.alpha_mode == AlphaMode::kMask;
    case Effect::kAlphaBlend:
      return m.alpha_mode == AlphaMode::kBlend;
    default:
      break;
  }
  if (m.unlit) return false;
  const auto& s = m.specular;
  switch (effect) {
    case Effect::kMetallicRoughnessTexture:
      return m.metallic_roughness_texture.has_value();
    case Effect::kNormalMap:
      return m.normal_texture.has_value() || (m.clearcoat.weight > 0 && m.clearcoat.normal_texture);
    case Effect::kReflection:
      return m.metallic > 0 || s.weight > 0;
    case Effect::kMirror:
      return (m.metallic > 0 || s.weight > 0) && m.roughness <= kMirrorRoughness;
    case Effect::kEmission:
      return is_emissive(m);
    case Effect::kTransmission:
      return m.transmission.weight > 0 && m.metallic < 1;
    case Effect::kRefraction:
      return refracts(m);
    case Effect::kVolume:
      return absorbs(m);
    case Effect::kIor:
      return m.ior != 1.5f && (m.metallic < 1 || m.metallic_roughness_texture);
    case Effect::kSpecular:
      return (s.weight != 1 || s.color != Vec3{1} || s.texture || s.color_texture) &&
             (m.metallic < 1 || m.metallic_roughness_texture);
    case Effect::kClearcoat:
      return m.clearcoat.weight > 0;
    case Effect::kSheen:
      return bright(m.sheen.color);
    case Effect::kIridescence:
      return m.iridescence.weight > 0;
    case Effect::kAnisotropy:
      return m.anisotropy.strength > 0;
    case Effect::kDoubleSided:
      return m.double_sided && is_emissive(m);   // back sides are drawn anyway, but glow only if told
    default:
      return false;
  }
}

bool is_of_materials(Effect effect) {
  return effect <= Effect::kUnlit && effect != Effect::kVertexColor;
}

using Kind = scene::PunctualLight::Kind;

std::optional<Kind> light_kind(Effect effect) {
  if (effect == Effect::kPointLights) return Kind::kPoint;
  if (effect == Effect::kSpotLights) return Kind::kSpot;
  if (effect == Effect::kDirectionalLights) return Kind::kDirectional;
  return std::nullopt;
}

std::uint32_t texture_reads(Effect effect) {
  switch (effect) {
    case Effect::kBaseColorTexture:
    case Effect::kMetallicRoughnessTexture:
    case Effect::kNormalMap:
    case Effect::kEmission:
    case Effect::kTransmission:
    case Effect::kAnisotropy:
    case Effect::kAlphaMask:
    case Effect::kAlphaBlend:
      return 1;
    case Effect::kSpecular:
    case Effect::kClearcoat:
    case Effect::kSheen:
    case Effect::kIridescence:
      return 2;
    default:
      return 0;
  }
}

class Planner {
 public:
  Planner(const scene::Scene& scene, const Config& config)
      : scene_(scene), config_(config), reached_(reached_materials(scene)) {}

  EffectsPlan plan() {
    for (std::size_t i = 0; i < kEffects; ++i) look_for(static_cast<Effect>(i));
    secondary_rays();
    const ShadingConfig::Effects& choice = config_.shading.effects;
    plan_.everything = choice.choice == ShadingConfig::Effects::Choice::kAll;
    for (std::size_t i = 0; i < kEffects; ++i) {
      PlannedEffect& e = plan_.effects[i];
      const auto named = std::find(choice.names.begin(), choice.names.end(), kEffectNames[i]) != choice.names.end();
      const bool left_out = choice.choice == ShadingConfig::Effects::Choice::kList && !named;
      e.on = plan_.everything || (e.called_for && !left_out);
      if (left_out && e.called_for) e.why += "; left out by shading.effects";
    }
    for (std::size_t i = 0; i < kEffects; ++i)
      if (plan_.effects[i].on) costs(static_cast<Effect>(i), plan_.effects[i].cost);
    return plan_;
  }

 private:
  PlannedEffect& at(Effect effect) { return plan_.effects[static_cast<std::size_t>(effect)]; }

  void look_for(Effect effect) {
    PlannedEffect& e = at(effect);
    if (is_of_materials(effect)) {
      call_materials(e, [&](const Material& m) { return material_calls(m, effect); });
    } else if (effect == Effect::kVertexColor) {
      for (const scene::Mesh& mesh : scene_.meshes) call(e, !mesh.colors.empty(), "mesh", mesh.name);
    } else if (effect == Effect::kAreaLights) {
      call_materials(e, is_emissive);
    } else if (const auto kind = light_kind(effect)) {
      for (std::size_t i = 0; i < scene_.lights.size(); ++i)
        call(e, scene_.lights[i].kind == *kind && bright(scene_.lights[i].intensity), "light", std::to_string(i));
    } else if (effect == Effect::kSky) {
      call(e, bright(scene_.sky.radiance), "sky", "");
    } else if (effect == Effect::kDepthOfField) {
      call(e, config_.camera.aperture > 0, "camera.aperture", "");
    }
    conclude(e);
  }

  template <class Predicate>
  void call_materials(PlannedEffect& e, const Predicate& calls) {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      const std::string& name = scene_.materials[i].name;
      call(e, reached_[i] && calls(scene_.materials[i]), "material", name.empty() ? std::to_string(i) : name);
    }
  }

  static void call(PlannedEffect& e, bool calls, const char* what, const std::string& name) {
    if (!calls) return;
    if (++e.callers == 1) e.why = fmt::format("{}{}{}", what, name.empty() ? "" : " ", name);
  }
  static void conclude(PlannedEffect& e) {
    e.called_for = e.callers > 0;
    if (e.callers > 1) e.why += fmt::format(" and {} more", e.callers - 1);
    if (!e.called_for) e.why = "nothing calls for it";
  }

  /// What they need is the other effects' presence.
  void secondary_rays() {
    const auto any = [&](std::initializer_list<Effect> list) {
      return std::any_of(list.begin(), list.end(), [&](Effect effect) { return at(effect).called_for; });
    };
    bool lit = false;
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) lit = lit || (reached_[i] && !scene_.materials[i].unlit);
    const bool lights = any({Effect::kPointLights, Effect::kSpotLights, Effect::kDirectionalLights, Effect::kAreaLights});
    PlannedEffect& shadow = at(Effect::kShadowRays);
    shadow.called_for = lit && lights;
    shadow.why = !lights ? "there is no light" : lit ? "lights and surfaces they shine on" : "no surface is lit";
    PlannedEffect& bounce = at(Effect::kBounceRays);
    const bool found = lights || any({Effect::kSky, Effect::kUnlit});
    const bool deep = config_.image.max_depth > 1;
    bounce.called_for = deep && lit && found;
    bounce.why = !deep ? "image.max_depth is 1" : !lit ? "no surface is lit" : found ? "surfaces send on light" : "there is no light to find";
    shadow.callers = shadow.called_for ? 1 : 0;
    bounce.callers = bounce.called_for ? 1 : 0;
  }

  void costs(Effect effect, EffectCost& cost) const {
    const auto depth = plan_.on(Effect::kBounceRays) ? static_cast<std::uint32_t>(config_.image.max_depth) : 1u;
    cost.texture_reads = texture_reads(effect);
    if (effect == Effect::kShadowRays) {
      cost.rays_per_path = depth;
      cost.path_state_bytes = depth * static_cast<std::uint32_t>(sizeof(Vec3));
    }
    if (effect == Effect::kBounceRays) cost.rays_per_path = depth - 1;
    if (effect == Effect::kVolume) cost.path_state_bytes = sizeof(std::uint32_t);
  }

  const scene::Scene& scene_;
  const Config& config_;
  std::vector<bool> reached_;
  EffectsPlan plan_;
};

/// What strips an effect off a material.
void take_off(Material& m, Effect effect) {
  switch (effect) {
    case Effect::kBaseColorTexture:
      m.base_color_texture.reset();
      break;
    case Effect::kMetallicRoughnessTexture:
      m.metallic_roughness_texture.reset();
      break;
    case Effect::kNormalMap:
      m.normal_texture.reset();
      m.clearcoat.normal_texture.reset();
      break;
    case Effect::kReflection:
      m.metallic = 0;
      m.specular = {.weight = 0, .color = Vec3{1}, .texture = {}, .color_texture = {}};
      break;
    case Effect::kMirror:
      if (m.roughness <= kMirrorRoughness) m.roughness = 0.3f;
      break;
    case Effect::kEmission:
      m.emissive = Vec3{0};
      m.emissive_texture.reset();
      break;
    case Effect::kTransmission:
      m.transmission = {};
      break;
    case Effect::kRefraction:
      m.volume.thickness = 0;
      break;
    case Effect::kVolume:
      m.volume.attenuation_distance = INFINITY;
      break;
    case Effect::kIor:
      m.ior = 1.5f;
      break;
    case Effect::kSpecular:
      m.specular = {};
      break;
    case Effect::kClearcoat:
      m.clearcoat = {};
      break;
    case Effect::kSheen:
      m.sheen = {};
      break;
    case Effect::kIridescence:
      m.iridescence = {};
      break;
    case Effect::kAnisotropy:
      m.anisotropy = {};
      break;
    case Effect::kAlphaMask:
      if (m.alpha_mode == AlphaMode::kMask) m.alpha_mode = AlphaMode::kOpaque;
      break;
    case Effect::kAlphaBlend:
      if (m.alpha_mode == AlphaMode::kBlend) m.alpha_mode = AlphaMode::kOpaque;
      break;
    case Effect::kDoubleSided:
      m.double_sided = false;
      break;
    case Effect::kUnlit:
      m.unlit = false;
      break;
    default:
      break;
  }
}

/// Every texture of a material, as far as shading reads it.
template <class Visit>
void visit_textures(const Material& m, const Visit& visit) {
  const auto one = [&](const std::optional<scene::TextureUse>& use) {
    if (use) visit(*use);
  };
  one(m.base_color_texture);
  if (m.unlit) return;
  one(m.metallic_roughness_texture);
  one(m.emissive_texture);
  one(m.normal_texture);
  if (m.transmission.weight > 0) one(m.transmission.texture);
  one(m.specular.texture);
  one(m.specular.color_texture);
  if (m.clearcoat.weight > 0) {
    one(m.clearcoat.texture);
    one(m.clearcoat.roughness_texture);
    one(m.clearcoat.normal_texture);
  }
  if (bright(m.sheen.color)) {
    one(m.sheen.color_texture);
    one(m.sheen.roughness_texture);
  }
  if (m.iridescence.weight > 0) {
    one(m.iridescence.texture);
    one(m.iridescence.thickness_texture);
  }
  if (m.anisotropy.strength > 0) one(m.anisotropy.texture);
}

}  // namespace

std::uint32_t EffectsPlan::path_state_bytes() const {
  std::uint32_t bytes = sizeof(PathState) + sizeof(std::uint32_t);
  for (const PlannedEffect& effect : effects) bytes += effect.cost.path_state_bytes;
  return bytes;
}

EffectsPlan plan_effects(const scene::Scene& scene, const Config& config) {
  return Planner(scene, config).plan();
}

void keep_effects(scene::Scene& scene, const ShadingConfig::Effects& choice) {
  if (choice.choice != ShadingConfig::Effects::Choice::kList) return;
  for (std::size_t i = 0; i < kEffects; ++i) {
    if (std::find(choice.names.begin(), choice.names.end(), kEffectNames[i]) != choice.names.end()) continue;
    const auto effect = static_cast<Effect>(i);
    for (Material& material : scene.materials) take_off(material, effect);
    if (effect == Effect::kVertexColor)
      for (scene::Mesh& mesh : scene.meshes) mesh.colors.clear();
    if (effect == Effect::kSky) scene.sky.radiance = Vec3{0};
    if (const auto kind = light_kind(effect))
      std::erase_if(scene.lights, [&](const scene::PunctualLight& light) { return light.kind == *kind; });
  }
}

std::uint64_t drop_unread_images(scene::Scene& scene) {
  const std::vector<bool> reached = reached_materials(scene);
  std::vector<bool> read(scene.images.size(), false);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (!reached[m]) continue;
    visit_textures(scene.materials[m],
                   [&](const scene::TextureUse& use) { read[scene.textures[use.texture.value].image.value] = true; });
  }
  std::uint64_t freed = 0;
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    if (read[i]) continue;
    freed += scene.images[i].rgba.size();
    scene.images[i].rgba = {};
    scene.images[i].width = scene.images[i].height = 0;
  }
  return freed;
}

bool has_layers(const Material& m) {
  return m.clearcoat.weight > 0 || bright(m.sheen.color);
}

bool has_interface(const Material& m) {
  const auto& s = m.specular;
  return m.ior != 1.5f || s.weight != 1 || s.color != Vec3{1} || s.texture || s.color_texture ||
         m.transmission.weight > 0 || m.iridescence.weight > 0 || m.anisotropy.strength > 0;
}

bool has_volume(const Material& m) {
  return m.transmission.weight > 0 && m.metallic < 1 && m.volume.thickness > 0;
}

bool refracts(const Material& m) {
  return has_volume(m) && m.ior >= 1 && std::abs(m.ior - 1) > kStraight;
}

bool absorbs(const Material& m) {
  const auto& v = m.volume;
  return has_volume(m) && std::isfinite(v.attenuation_distance) && v.attenuation_distance > 0 && v.attenuation_color != Vec3{1};
}

std::string_view class_name(SurfaceClass surface) {
  constexpr std::array<std::string_view, kSurfaceClasses> kNames{
      "unlit", "plain", "textured", "layered", "opaque", "layered_opaque", "transmissive", "layered_transmissive", "anything"};
  return kNames[static_cast<std::size_t>(surface)];
}

namespace {

SurfaceClass surface_class(const Material& m, bool colors) {
  if (m.unlit) return SurfaceClass::kUnlit;
  const bool layers = has_layers(m);
  if (m.transmission.weight > 0 && m.metallic < 1)
    return layers ? SurfaceClass::kLayeredTransmissive : SurfaceClass::kTransmissive;
  if (has_interface(m)) return layers ? SurfaceClass::kLayeredOpaque : SurfaceClass::kOpaque;
  if (layers) return SurfaceClass::kLayered;
  const bool textures = m.base_color_texture || m.metallic_roughness_texture || m.normal_texture || colors;
  return textures ? SurfaceClass::kTextured : SurfaceClass::kPlain;
}

}  // namespace

std::vector<SurfaceClass> surface_classes(const scene::Scene& scene, const EffectsPlan& plan) {
  std::vector<bool> colors(scene.materials.size(), false);
  for (const scene::Mesh& mesh : scene.meshes) {
    if (mesh.colors.empty()) continue;
    for (const MaterialId id : mesh.triangle_materials) colors[id.value] = true;
  }
  std::vector<SurfaceClass> classes;
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    classes.push_back(plan.everything ? SurfaceClass::kAnything : surface_class(scene.materials[i], colors[i]));
  return classes;
}

std::vector<std::pair<SurfaceClass, std::uint32_t>> count_classes(const scene::Scene& scene, const EffectsPlan& plan) {
  const std::vector<bool> reached = reached_materials(scene);
  const std::vector<SurfaceClass> classes = surface_classes(scene, plan);
  std::array<std::uint32_t, kSurfaceClasses> counts{};
  for (std::size_t i = 0; i < classes.size(); ++i) counts[static_cast<std::size_t>(classes[i])] += reached[i] ? 1u : 0u;
  std::vector<std::pair<SurfaceClass, std::uint32_t>> out;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) out.emplace_back(static_cast<SurfaceClass>(i), counts[i]);
  return out;
}

std::vector<std::uint32_t> extra_effects(const scene::Scene& scene, const EffectsPlan& plan) {
  constexpr std::array kExtra{Effect::kBaseColorTexture, Effect::kMetallicRoughnessTexture, Effect::kNormalMap,
                              Effect::kTransmission, Effect::kRefraction, Effect::kVolume, Effect::kIor, Effect::kSpecular,
                              Effect::kClearcoat, Effect::kSheen, Effect::kIridescence, Effect::kAnisotropy};
  std::vector<std::uint32_t> counts;
  for (const Material& material : scene.materials) {
    const auto has = [&](Effect effect) { return plan.everything || material_calls(material, effect); };
    counts.push_back(static_cast<std::uint32_t>(std::count_if(kExtra.begin(), kExtra.end(), has)));
  }
  return counts;
}

}  // namespace carousel::shading
