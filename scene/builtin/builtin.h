#pragma once

#include <cstdint>

#include "core/config/fields/scene.h"
#include "scene/model/scene.h"

namespace carousel::scene {

// Built-in scenes, generated without any file. Equal arguments give the same bits, on any number of
// threads. Triangle and instance counts are aims, met as closely as the shapes allow, at least one.

/// A closed Cornell box: coloured walls, a ceiling light, a brushed metal box, a white box with a metal ball.
Scene make_cornell();
/// Spheres of many colours, metals and roughnesses on a ground, about `triangles` of them in one mesh; or,
/// `procedural`, the same spheres as such.
Scene make_spheres(std::int64_t triangles, std::int64_t seed, bool procedural = false);
/// A height field of fractal noise coloured by height and slope, one mesh of about `triangles`.
Scene make_terrain(std::int64_t triangles, std::int64_t seed);
/// `instances` placements of a few small meshes: rotated, scaled unequally, every fourth mirrored. With more than two
/// `levels` they stand in groups of groups: 3 levels have one depth of groups.
Scene make_instances(std::int64_t instances, std::int64_t seed, std::int64_t levels = 2);
/// A burst of needles, `triangles` of them, length over width from 10 to 100,000.
Scene make_sliver(std::int64_t triangles, std::int64_t seed);

/// The scene `config.builtin` names (which must be set), with its own sky; `config.sky` is not looked at.
/// Throws ConfigError when a count is outside [1, 2^28].
Scene make_builtin(const SceneConfig& config);

}  // namespace carousel::scene
