#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"

namespace carousel::scene {

/// Unpacks KHR_draco_mesh_compression into accessors, mesh by mesh, for MeshReader to read like any others.
class DracoReader {
 public:
  /// Keeps references to all arguments.
  DracoReader(const GltfDocument& document, AccessorTable& accessors, const ImportBudget& budget);

  /// Gives the accessors of the mesh's compressed primitives their data; call before the mesh is read. A primitive
  /// whose accessors all have data of their own (a fallback) is left as it is where the extension is optional. Throws
  /// SceneError for streams that are broken, announce more than the memory of the import holds (before
  /// anything is allocated for them), hold other numbers of elements than the accessors say, or lack an attribute. Some
  /// writers name one accessor for several attributes of a stream (two sets of texture coordinates): each then gets an
  /// accessor of its own, and `attributes` of tinygltf's primitive is changed to name it.
  void decode(std::size_t mesh, tinygltf::Mesh& model);

 private:
  using Source = std::pair<std::size_t, std::int64_t>;  ///< buffer view and attribute of the stream, or kIndices

  void decode_primitive(const Json& primitive, const std::string& path, tinygltf::Primitive& model);
  std::size_t accessor_for(std::size_t named, const Source& source);

  const GltfDocument& document_;
  AccessorTable& accessors_;
  const ImportBudget& budget_;
  const bool required_;                    ///< the file requires the extension
  std::map<std::size_t, Source> sources_;  ///< the source of an accessor's data
  /// The accessors that stand for one of the file whose data has another source.
  std::map<std::pair<std::size_t, Source>, std::size_t> others_;
};

}  // namespace carousel::scene
