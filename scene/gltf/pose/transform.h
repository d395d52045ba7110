#pragma once

#include <optional>
#include <string>

#include <tiny_gltf.h>

#include "core/types/vec.h"
#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// T * R * S in double; the quaternion (x, y, z, w) is normalised first. Empty if it has no direction.
std::optional<DMat4> compose_trs(const DVec3& translation, const double (&rotation)[4], const DVec3& scale);

/// The local transform of a node. Throws SceneError at `path`: a matrix that is no affine map, a quaternion
/// of length zero.
DMat4 node_transform(const GltfDocument& document, const tinygltf::Node& node, const std::string& path);

/// Rounds to single precision, once. Throws SceneError at `path` when an entry is not finite there.
Affine rounded(const GltfDocument& document, const DMat4& world, const std::string& path);

/// The direction of a normal where `m` moves its surface, of length 1; the normal itself where `m` leaves it none.
DVec3 moved_normal(const DMat4& m, const DVec3& normal);

/// Right, up and back of an object that looks along its own -z (cameras, lights), without scale and mirroring. Empty if
/// the map flattens the view direction.
struct Frame {
  Vec3 right, up, back;
};
std::optional<Frame> orthonormal_frame(const DMat4& world);

}  // namespace carousel::scene
