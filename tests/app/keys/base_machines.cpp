#include "tests/app/keys/base_machines.h"

#include <random>

#include <fmt/format.h>

#include "tests/scene/gltf/gltf_builder.h"
#include "tests/scene/gltf/pose/moving_models.h"
#include "tests/support/hdr_file.h"

namespace carousel {

namespace {

/// Two alpha-blended squares, one of them rotated, before two coated ones, one of which shows its back. Animations move
/// the first.
std::string layers(double roughness) {
  using Json = scene::GltfBuilder::Json;
  scene::GltfBuilder b;
  const int positions = b.floats({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3", 3);
  const int indices = b.accessor(b.view(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}), 5123, 6, "SCALAR");
  b.push(
      "materials",
      {{"alphaMode", "BLEND"}, {"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}});
  b.push("materials", {{"doubleSided", true},
                       {"pbrMetallicRoughness", {{"roughnessFactor", roughness}}},
                       {"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}}}}}});
  b.json["extensionsUsed"] = {"KHR_materials_clearcoat"};
  b.mesh({{"POSITION", positions}}, indices, {{"material", 0}});
  b.mesh({{"POSITION", positions}}, indices, {{"material", 1}});
  b.json["nodes"][1].update(Json{{"translation", {0, 0, -1}}, {"scale", {2, 2, 2}}});
  b.node({{"mesh", 0}, {"translation", {0.3, 0.2, -0.5}}, {"rotation", {0, 0.3826834, 0, 0.9238795}}});
  b.node({{"mesh", 1}, {"translation", {-0.6, 0.3, 0.6}}, {"rotation", {0, 1, 0, 0}}, {"scale", {0.7, 0.7, 0.7}}});
  for (const double field_of_view : {0.8, 1.2}) {
    const int camera =
        b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", field_of_view}, {"znear", 0.1}}}});
    b.node({{"camera", camera}, {"translation", {0, 0, 3}}});
  }
  scene::animate(b, 0, "translation", {0, 2}, {0, 0, 0, 0.4f, 0, 0}, "VEC3", 3, "LINEAR", "shift");
  scene::animate(b, 0, "translation", {0, 2}, {0, 0, 0, 0, 0.5f, 0}, "VEC3", 3, "LINEAR", "lift");
  return b.text();
}

/// Rays from inside the Cornell box to points on its edges, where the rounding of a box test decides; each is there
/// eight times, so that they make bundles.
std::string rays_to_edges(int points) {
  constexpr double kLo[] = {-1, 0, -1.4}, kHi[] = {1, 2, 2.6};
  std::mt19937 random(5);
  const auto between = [&](double lo, double hi) { return lo + (hi - lo) * (random() / 4294967296.0); };
  std::string out = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int ray = 0; ray < 8 * points;) {
    float from[3], to[3];
    const unsigned axis = random() % 3;
    for (unsigned i = 0; i < 3; ++i) {
      const double inset = 0.1 * (kHi[i] - kLo[i]);
      from[i] = static_cast<float>(between(kLo[i] + inset, kHi[i] - inset));
      to[i] = static_cast<float>(i == axis ? between(kLo[i], kHi[i]) : random() % 2 == 0 ? kLo[i] : kHi[i]);
    }
    for (int copy = 0; copy < 8; ++copy)
      out += fmt::format("{},camera,{},{},{},{},{},{},0,inf\n", ray++, from[0], from[1], from[2], to[0] - from[0],
                         to[1] - from[1], to[2] - from[2]);
  }
  return out;
}

}  // namespace

void write_scenes_and_rays(const Program& program) {
  program.write("layers.gltf", layers(0.9));
  program.write("other.gltf", layers(0.2));
  program.write("map.hdr", hdr_file(8, 4, [](int x, int y) { return Vec3{float(x), float(y), 1}; }));
  program.write("copies.csv", rays_to_edges(60));
  program.write("fewer.csv", rays_to_edges(30));
  program.write("trees.yaml",
                "scene: {builtin: cornell}\nimage: {width: 2, height: 2, samples: 1}\nbvh: {leaf_triangles: 1}\n");
  program.run({"run", "trees.yaml", "--dump-trees", "small_leaves.trees", "--no-html", "--quiet"});
}

}  // namespace carousel
