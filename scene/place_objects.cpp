#include "scene/place_objects.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "core/config/primitive_program.h"
#include "core/numeric/trigonometry.h"
#include "core/system/error.h"

namespace carousel::scene {

namespace {

/// A turn by so many degrees about an axis.
DMat3 turned(int axis, double degrees) {
  const auto [s, c] = sin_cos(degrees * (std::numbers::pi / 180));
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  DMat3 out(1.0);
  out[i][i] = c, out[j][j] = c;
  out[i][j] = s, out[j][i] = -s;
  return out;
}

Affine placement_of(const SceneObject& object) {
  DMat3 linear(1.0);
  for (int axis = 0; axis < 3; ++axis)
    if (object.turn[axis] != 0) linear = turned(axis, double{object.turn[axis]}) * linear;
  return {Mat3(linear * double{object.scale}), object.at};
}

/// The primitive between its bounds, which are moved outwards where their middle is not a float.
Sphere bounded(const PrimitiveBounds& bounds, std::uint32_t program, MaterialId material) {
  Sphere out{.material = material, .program = program};
  out.center = Vec3(0.5 * (DVec3(bounds.low) + DVec3(bounds.high)));
  const DVec3 middle(out.center), half = glm::max(DVec3(bounds.high) - middle, middle - DVec3(bounds.low));
  for (int axis = 0; axis < 3; ++axis) {
    const auto nearest = static_cast<float>(half[axis]);
    out.half[axis] =
        double{nearest} < half[axis] ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
  }
  constexpr double kOutwards = 1 + 0x1p-20;
  out.radius = static_cast<float>(kOutwards * glm::length(DVec3(out.half)));
  return out;
}

class Placer {
 public:
  Placer(Scene& scene, const PrimitivesConfig& primitives, const ProgramsConfig& programs)
      : scene_(scene), primitives_(primitives), programs_(programs) {}

  void place(const SceneObject& object, std::size_t number) {
    const auto found = primitives_.named.find(object.primitive);
    if (found == primitives_.named.end())
      throw ConfigError(fmt::format("scene.objects.{}.primitive", number),
                        fmt::format("expected a name of primitives, found '{}'", object.primitive));
    const std::array<float, 5> look{object.color.x, object.color.y, object.color.z, object.metallic, object.roughness};
    const auto [mesh, fresh] = meshes_.try_emplace({object.primitive, look}, scene_.meshes.size());
    if (fresh) add_mesh(object, found->second);
    Instance& instance = scene_.instances.emplace_back();
    instance.mesh = MeshId(static_cast<std::uint32_t>(mesh->second));
    instance.world_from_model = placement_of(object);
  }

 private:
  void add_mesh(const SceneObject& object, const PrimitiveConfig& primitive) {
    const MaterialId material(static_cast<std::uint32_t>(scene_.materials.size()));
    Material& made = scene_.materials.emplace_back();
    made.name = object.primitive;
    made.base_color = Vec4(object.color, 1);
    made.metallic = object.metallic;
    made.roughness = object.roughness;
    Mesh& mesh = scene_.meshes.emplace_back();
    mesh.name = object.primitive;
    mesh.spheres.push_back(bounded(primitive.bounds, program(object.primitive, primitive), material));
  }
  std::uint32_t program(const std::string& name, const PrimitiveConfig& primitive) {
    const auto [number, fresh] = numbers_.try_emplace(name, static_cast<std::uint32_t>(scene_.programs.size()));
    if (!fresh) return number->second;
    ProgramFault fault;
    const std::optional<RayProgram> compiled = program_of(primitive, programs_, fault);
    if (!compiled) throw ConfigError(fmt::format("primitives.{}.program.{}", name, fault.line), fault.message);
    scene_.programs.push_back(*compiled);
    return number->second;
  }

  Scene& scene_;
  const PrimitivesConfig& primitives_;
  const ProgramsConfig& programs_;
  std::map<std::pair<std::string, std::array<float, 5>>, std::size_t> meshes_;
  std::map<std::string, std::uint32_t> numbers_;  // of programs
};

}  // namespace

void place_objects(Scene& scene, const SceneConfig& config, const PrimitivesConfig& primitives,
                   const ProgramsConfig& programs) {
  Placer placer(scene, primitives, programs);
  for (std::size_t i = 0; i < config.objects.size(); ++i) placer.place(config.objects[i], i);
}

}  // namespace carousel::scene
