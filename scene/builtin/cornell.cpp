#include <cmath>

#include "core/numeric/trigonometry.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

void add_instance(Scene& scene, Mesh mesh, float turn, Vec3 translation) {
  scene.meshes.push_back(std::move(mesh));
  Instance instance;
  instance.mesh = MeshId(static_cast<std::uint32_t>(scene.meshes.size() - 1));
  const float c = cos_float(turn), s = sin_float(turn);
  instance.world_from_model = {Mat3(c, 0, -s, 0, 1, 0, s, 0, c), translation};
  scene.instances.push_back(instance);
}

/// Walls that face inwards. The room goes on behind the camera, so that no ray escapes.
Mesh make_room(MaterialId white, MaterialId left, MaterialId right) {
  const float x = 1, y = 2, back = -1.4f, front = 2.6f;
  Mesh room;
  room.name = "room";
  add_quad(room, {-x, 0, front}, {x, 0, front}, {x, 0, back}, {-x, 0, back}, white);    // floor
  add_quad(room, {-x, y, back}, {x, y, back}, {x, y, front}, {-x, y, front}, white);    // ceiling
  add_quad(room, {-x, 0, back}, {x, 0, back}, {x, y, back}, {-x, y, back}, white);      // back
  add_quad(room, {x, 0, front}, {-x, 0, front}, {-x, y, front}, {x, y, front}, white);  // front
  add_quad(room, {-x, 0, front}, {-x, 0, back}, {-x, y, back}, {-x, y, front}, left);
  add_quad(room, {x, 0, back}, {x, 0, front}, {x, y, front}, {x, y, back}, right);
  return room;
}

}  // namespace

Scene make_cornell() {
  Scene scene;
  scene.name = "cornell";
  const MaterialId white = add_material(scene, "white", {0.73f, 0.71f, 0.68f}, 0, 1);
  const MaterialId red = add_material(scene, "red", {0.63f, 0.06f, 0.05f}, 0, 1);
  const MaterialId green = add_material(scene, "green", {0.14f, 0.45f, 0.09f}, 0, 1);
  const MaterialId steel = add_material(scene, "steel", {0.78f, 0.80f, 0.83f}, 1, 0.18f);
  const MaterialId copper = add_material(scene, "copper", {0.93f, 0.55f, 0.37f}, 1, 0.25f);
  const MaterialId emissive_material = add_material(scene, "lamp", {0.78f, 0.78f, 0.78f}, 0, 1);
  scene.materials[emissive_material.value].emissive = {18.0f, 14.0f, 9.0f};

  add_instance(scene, make_room(white, red, green), 0, {0, 0, 0});

  Mesh light;  // a little below the ceiling: coplanar surfaces would fight
  light.name = "lamp";
  add_quad(light, {-0.32f, 0, -0.27f}, {0.32f, 0, -0.27f}, {0.32f, 0, 0.27f}, {-0.32f, 0, 0.27f}, emissive_material);
  add_instance(scene, std::move(light), 0, {0, 1.995f, -0.45f});

  Mesh tall;
  tall.name = "tall box";
  add_box(tall, {-0.3f, 0, -0.3f}, {0.3f, 1.2f, 0.3f}, steel);
  add_instance(scene, std::move(tall), 0.31f, {-0.36f, 0, -0.8f});

  Mesh low;
  low.name = "short box";
  add_box(low, {-0.3f, 0, -0.3f}, {0.3f, 0.6f, 0.3f}, white);
  add_instance(scene, std::move(low), -0.29f, {0.37f, 0, -0.28f});

  Mesh ball;
  ball.name = "ball";
  add_icosphere(ball, {0, 0, 0}, 0.24f, 3, copper);
  add_instance(scene, std::move(ball), 0, {0.37f, 0.8395f, -0.28f});

  scene.cameras.push_back(look_at({0, 1, 2.5f}, {0, 1, 0}, 0.76f));
  scene.cameras.back().name = "front";
  return scene;
}

}  // namespace carousel::scene
