#pragma once

#include <cstdint>

#include "scene/model/scene.h"

namespace carousel::scene {

// Shapes the built-in scenes are made of. Each appends to a mesh, counter-clockwise seen from outside, and
// keeps its arrays consistent: a mesh that has normals gets them for the new vertices too.

/// A material of one colour, appended to the scene's.
MaterialId add_material(Scene& scene, const char* name, Vec3 color, float metallic, float roughness);

/// Two triangles a, b, c and a, c, d, flat normal of a, b, c.
void add_quad(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d, MaterialId material);

/// The box [lo, hi], 12 triangles, flat normals, outside outward.
void add_box(Mesh& mesh, Vec3 lo, Vec3 hi, MaterialId material);

/// 20 * 4^level triangles of an icosphere with smooth normals; level 0 to 8.
void add_icosphere(Mesh& mesh, Vec3 centre, float radius, int level, MaterialId material);

/// A torus around y, 2 * around * across triangles, smooth normals.
void add_torus(Mesh& mesh, float major_radius, float minor_radius, int around, int across, MaterialId material);

/// A cone from y = 0 to y = height without its base, `around` triangles, smooth normals.
void add_cone(Mesh& mesh, float radius, float height, int around, MaterialId material);

}  // namespace carousel::scene
