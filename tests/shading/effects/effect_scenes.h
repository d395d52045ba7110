#pragma once

#include <cmath>

#include "core/types/effect.h"
#include "scene/model/scene.h"
#include "tests/shading/path/small_scenes.h"

namespace carousel::shading {

/// A closed box around `c`, corners counter-clockwise from outside, with texture coordinates.
inline void add_box(scene::Scene& scene, const Vec3& c, float half, std::uint32_t material) {
  const auto face = [&](const Vec3& n, const Vec3& u, const Vec3& v) {
    add_quad(scene, c + half * (n - u - v), c + half * (n + u - v), c + half * (n + u + v), c + half * (n - u + v),
             material);
    scene.meshes.back().uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  };
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  face(x, y, z);
  face(-x, z, y);
  face(y, z, x);
  face(-y, x, z);
  face(z, x, y);
  face(-z, y, x);
}

/// A floor, an emissive quad and a sky, with a box in the middle that has `material`.
inline scene::Scene box_on_floor(const scene::Material& material) {
  scene::Scene scene = empty_scene();
  scene.images.push_back({"noise", 2, 2, {250, 30, 60, 255, 40, 240, 90, 10, 20, 60, 250, 200, 128, 128, 255, 90}});
  scene.textures.push_back({ImageId(0), scene::Wrap::kRepeat, scene::Wrap::kRepeat, true});
  const std::uint32_t floor = add_material(scene, matte({0.7f, 0.6f, 0.5f}));
  const std::uint32_t light = add_material(scene, emissive_material({6, 5, 4}));
  const std::uint32_t box = add_material(scene, material);
  add_quad(scene, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}, floor);
  add_quad(scene, {-1, 4, -1}, {1, 4, -1}, {1, 4, 1}, {-1, 4, 1}, light);
  add_box(scene, {0, 0, 0}, 0.9f, box);
  scene.sky.radiance = {0.3f, 0.4f, 0.6f};
  scene.cameras[0].position = {0.4f, 0.5f, 4.5f};
  return scene;
}

/// A scene that calls for an effect; forcing that effect off has to change the picture.
inline scene::Scene scene_that_calls_for(Effect effect) {
  using Kind = scene::PunctualLight::Kind;
  scene::Material m = matte({0.9f, 0.5f, 0.4f});
  m.roughness = 0.4f;
  scene::Scene scene;
  switch (effect) {
    case Effect::kBaseColorTexture:
      m.base_color_texture.emplace();
      break;
    case Effect::kMetallicRoughnessTexture:
      m.metallic = 1;
      m.metallic_roughness_texture.emplace();
      break;
    case Effect::kNormalMap:
      m.normal_texture.emplace();
      break;
    case Effect::kVertexColor:
      scene = box_on_floor(m);
      scene.meshes[2].colors = {Vec4{1, 0, 0, 1}, Vec4{0, 1, 0, 1}, Vec4{0, 0, 1, 1}, Vec4{1}};
      scene.meshes[6].colors = scene.meshes[2].colors;
      return scene;
    case Effect::kMirror:
      m.metallic = 1;
      m.roughness = 0;
      break;
    case Effect::kEmission:
      m.emissive = {0.5f, 0.2f, 0.1f};
      break;
    case Effect::kTransmission:
      m.transmission.weight = 0.8f;
      break;
    case Effect::kTransparentShadows:
      m.roughness = 0;
      m.transmission.weight = 0.8f;
      break;
    case Effect::kRefraction:
    case Effect::kVolume:
      m.roughness = 0;
      m.transmission.weight = 1;
      m.volume = {.thickness = 1,
                  .thickness_texture = {},
                  .attenuation_color = {0.2f, 0.8f, 0.4f},
                  .attenuation_distance = 0.7f};
      break;
    case Effect::kIor:
      m.ior = 2.2f;
      break;
    case Effect::kSpecular:
      m.specular.weight = 0.7f;
      m.specular.color = {1, 0.2f, 0.1f};
      break;
    case Effect::kClearcoat:
      m.clearcoat.weight = 1;
      break;
    case Effect::kSheen:
      m.sheen.color = {0.9f, 0.8f, 1};
      m.sheen.roughness = 0.5f;
      break;
    case Effect::kIridescence:
      m.metallic = 1;
      m.iridescence.weight = 1;
      break;
    case Effect::kAnisotropy:
      m.metallic = 1;
      m.anisotropy.strength = 0.9f;
      m.anisotropy.rotation = 0.5f;
      break;
    case Effect::kAlphaMask:
    case Effect::kAlphaBlend:
      m.base_color_texture.emplace();
      m.alpha_mode = effect == Effect::kAlphaMask ? scene::AlphaMode::kMask : scene::AlphaMode::kBlend;
      break;
    case Effect::kDoubleSided:
      scene = box_on_floor(m);
      scene.materials[1].double_sided = true;
      scene.cameras[0].position.y = 6;
      scene.cameras[0].back = {0, 0.6f, 0.8f};
      scene.cameras[0].up = {0, 0.8f, -0.6f};
      return scene;
    case Effect::kUnlit:
      m.unlit = true;
      break;
    case Effect::kPointLights:
    case Effect::kSpotLights:
    case Effect::kDirectionalLights: {
      scene = box_on_floor(m);
      scene::PunctualLight light;
      light.kind = effect == Effect::kPointLights  ? Kind::kPoint
                   : effect == Effect::kSpotLights ? Kind::kSpot
                                                   : Kind::kDirectional;
      light.position = {1.5f, 2, 2};
      light.direction = {-0.48f, -0.6f, -0.64f};
      light.intensity = Vec3{4};
      scene.lights.push_back(light);
      return scene;
    }
    case Effect::kEnvironmentMap:
      scene = box_on_floor(m);
      scene.sky.map = {"map", 2, 2, {Vec3{1, 2, 3}, Vec3{4, 0, 1}, Vec3{0.5f}, Vec3{0}}, 0.1f};
      return scene;
    default:
      break;
  }
  return box_on_floor(m);
}

/// All layers at once on one box, with an alpha-blended and an unlit quad.
inline scene::Scene scene_of_everything() {
  scene::Scene scene = box_on_floor([] {
    scene::Material m = matte({0.8f, 0.9f, 0.7f});
    m.roughness = 0.2f;
    m.transmission.weight = 0.7f;
    m.volume = {
        .thickness = 1, .thickness_texture = {}, .attenuation_color = {0.5f, 0.8f, 0.9f}, .attenuation_distance = 1};
    m.clearcoat.weight = 0.5f;
    m.sheen.color = {0.3f, 0.2f, 0.1f};
    m.sheen.roughness = 0.4f;
    m.iridescence.weight = 0.5f;
    m.anisotropy.strength = 0.5f;
    m.specular.color = {0.9f, 0.7f, 0.5f};
    return m;
  }());
  scene::Material blended = matte({0.2f, 0.3f, 0.9f}), flat = matte({0.3f, 0.6f, 0.2f});
  blended.alpha_mode = scene::AlphaMode::kBlend;
  blended.base_color.a = 0.4f;
  flat.unlit = true;
  const std::uint32_t v = add_material(scene, blended), f = add_material(scene, flat);
  add_quad(scene, {-2, -1, 1.5f}, {0, -1, 1.5f}, {0, 1, 1.5f}, {-2, 1, 1.5f}, v);
  add_quad(scene, {1, -1, -2}, {3, -1, -2}, {3, 1, -2}, {1, 1, -2}, f);
  scene::PunctualLight light;
  light.position = {2, 2, 3};
  light.intensity = {3, 4, 5};
  scene.lights.push_back(light);
  return scene;
}

}  // namespace carousel::shading
