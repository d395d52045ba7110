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
  DracoReader(const GltfDocument& document, AccessorTable& accessors, ImportBudget& budget)
      : document_(document), accessors_(accessors), budget_(budget) {}

  /// Gives the accessors of the mesh's compressed primitives their data; call before the mesh is read. A primitive
  /// whose accessors all have data of their own (a fallback) is left as it is. Throws SceneError for streams that are
  /// broken, declare more triangles or vertices than so few bytes can hold (before anything is allocated for them),
  /// hold other numbers of elements than the accessors say, or lack an attribute.
  void decode(std::size_t mesh);

 private:
  void decode_primitive(const Json& primitive, const std::string& path);

  const GltfDocument& document_;
  AccessorTable& accessors_;
  ImportBudget& budget_;
  /// Source of an accessor's data: buffer view and attribute of the stream, or kIndices.
  std::map<std::size_t, std::pair<std::size_t, std::int64_t>> sources_;
};

}  // namespace carousel::scene
