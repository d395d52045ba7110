#pragma once

#include <cstdint>

#include "core/config/fields/scene.h"
#include "scene/model/scene.h"

namespace carousel::scene {

// Built-in scenes, generated without any file. Equal arguments give the same bits, on any number of
// threads. Triangle and instance counts are aims, met as closely as the shapes allow, at least one. `seconds` is the
// moment at which a scene is shown that moves; it has the same meshes, triangles and instances at each.

/// A closed Cornell box: coloured walls, a ceiling light, a brushed metal box, a white box with a metal ball.
Scene make_cornell();
/// Spheres of many colours, metals and roughnesses on a ground, about `triangles` of them in one mesh; or,
/// `procedural`, the same spheres as such. Each goes round the middle of the field at a speed of its own.
Scene make_spheres(std::int64_t triangles, std::int64_t seed, bool procedural = false, float seconds = 0);
/// A height field of fractal noise coloured by height and slope, one mesh of about `triangles`. Waves go over it.
Scene make_terrain(std::int64_t triangles, std::int64_t seed, float seconds = 0);
/// `instances` placements of a few small meshes: rotated, scaled unequally, every fourth mirrored. With more than two
/// `levels` they stand in groups of groups, which do not move: 3 levels have one depth of groups. Those in no group go
/// round the middle, the inner ones faster, and turn as they go.
Scene make_instances(std::int64_t instances, std::int64_t seed, std::int64_t levels = 2, float seconds = 0);
/// A burst of needles, `triangles` of them, length over width from 10 to 100,000.
Scene make_sliver(std::int64_t triangles, std::int64_t seed);

/// Nine trees on a meadow with one crown of about `triangles`: leaf cards, two each, whose alpha texture cuts the
/// leaves out of them.
Scene make_foliage(std::int64_t triangles, std::int64_t seed);

/// A cloud of `count` flat Gaussians on a ball with waves (Scene::gaussians); place_gaussians() gives them shapes.
Scene make_gaussians(std::int64_t count, std::int64_t seed, int degree = 0);

/// The scene `config.builtin` names (which must be set), with its own sky; `config.sky` is not looked at.
/// Throws ConfigError when a count is outside [1, 2^28].
Scene make_builtin(const SceneConfig& config);

}  // namespace carousel::scene
