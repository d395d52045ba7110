#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"
#include "scene/gltf/pose/bend.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Turns glTF meshes into scene::Mesh.
class MeshReader {
 public:
  /// `default_material` is the material of primitives that name none.
  MeshReader(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
             const ImportBudget& budget, MaterialId default_material, WarningSink warn);
  ~MeshReader();

  /// The triangles of all primitives in order; strips and fans become lists. Primitives with the same
  /// attributes share their vertices. Where only some primitives have normals, the others get flat ones.
  /// Points, lines and primitives without positions are skipped and counted. Texture coordinates that no texture reads
  /// may be wrong: they are left out with a warning. With `bend` vertices are moved before flat normals are made.
  /// Throws SceneError.
  Mesh read(std::size_t mesh, const Bend* bend = nullptr);

  std::size_t skipped_primitives() const { return skipped_; }

 private:
  struct Attributes;
  struct Cache;

  /// The primitive's attributes; valid until the next call. The last ones are kept, because exporters like to
  /// let many primitives share one set of vertices.
  const Attributes& attributes_of(const tinygltf::Primitive& primitive, const std::string& path, const Bend* bend);
  Attributes read_attributes(const tinygltf::Primitive& primitive, const std::string& path,
                             const std::array<bool, 2>& reads) const;
  std::vector<std::uint32_t> read_triangles(const tinygltf::Primitive& primitive, std::uint64_t vertices,
                                            const std::string& path);
  static Attributes picked(const Attributes& from, const std::vector<std::uint32_t>& vertices);
  /// Appends vertices. `taken`: the bytes of the mesh's vertices so far, as the budget knows them.
  void add_vertices(Mesh& mesh, const Attributes& more, std::uint64_t& taken, const std::string& path) const;

  const GltfDocument& document_;
  const tinygltf::Model& model_;
  const AccessorTable& accessors_;
  const ImportBudget& budget_;
  MaterialId default_material_;
  WarningSink warn_;
  std::unique_ptr<Cache> cache_;
  std::size_t skipped_ = 0;
};

}  // namespace carousel::scene
