#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/merged_meshes.h"
#include "accel/structure/number_ranges.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The meshes that one structure is built over: one, or several of triangles alone, whose triangles are numbered
/// through. Keeps pointers to them.
class BlasMeshes {
 public:
  explicit BlasMeshes(const scene::Mesh& mesh) { add(mesh); }
  void add(const scene::Mesh& mesh) {
    meshes_.push_back(&mesh);
    ranges_.add(static_cast<std::uint32_t>(triangles_));
    triangles_ += mesh.triangle_count();
  }

  std::size_t triangles() const { return triangles_; }
  /// With the spheres, which have the numbers behind the triangles.
  std::size_t size() const { return triangles_ + (meshes_.size() == 1 ? meshes_.front()->spheres.size() : 0); }
  const scene::Mesh& front() const { return *meshes_.front(); }

  struct Triangle {
    const scene::Mesh* mesh;
    std::uint32_t index;
  };
  Triangle triangle(std::uint32_t number) const {
    if (meshes_.size() == 1) return {meshes_.front(), number};
    const NumberRanges::Place place = ranges_.place(number);
    return {meshes_[place.range], place.index};
  }

 private:
  std::vector<const scene::Mesh*> meshes_;
  NumberRanges ranges_;  // one a mesh
  std::size_t triangles_ = 0;
};

/// Finds the meshes of triangles that stand in the world once, without a transform and in no group, and if there are
/// several, appends one source to `sources`, which must be empty. A triangle's own box lies in its mesh's, so the box
/// of the mesh decides nothing for it, and hits stay what they are. Throws SceneError for more than 2^31 triangles.
MergedMeshes merge_meshes(const scene::Scene& scene, std::vector<BlasMeshes>& sources);

}  // namespace carousel::accel
