#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/buffers/model.h"
#include "scene/gltf/document/document.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// The numbers of component types in glTF.
enum class Component : int {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

std::size_t size_of(Component component);
const char* name_of(Component component);

/// The use of an accessor; it decides which element and component types are allowed.
enum class AccessorUse {
  kPosition,
  kNormal,
  kTexCoord,
  kColor,  // mesh attributes
  kTranslation,
  kRotation,
  kScale,  // EXT_mesh_gpu_instancing, and animations
  kIndices,
  kMorphPosition,
  kMorphNormal,
  kJoints,
  kSkinWeights,
  kInverseBind,
  kTime,
  kTurn,  // a rotation of an animation
  kMorphWeight,
  kOpacity  // of Gaussians
};

/// The accessors of a file, each checked against its buffer views before anything is allocated for it.
class AccessorTable {
 public:
  /// Throws SceneError at the accessor that reaches outside its buffer view; where no mesh and no instances use it,
  /// warns instead. `unpacked` holds the bytes of buffer views that were compressed. All arguments must outlive the
  /// table.
  AccessorTable(const GltfDocument& document, const GltfModel& model, const std::map<std::size_t, Bytes>& unpacked,
                const ImportBudget& budget, const WarningSink& warn);

  /// From here on the accessor reads `bytes`: its elements one after the other, of its own type. The position of its
  /// data in the file is forgotten.
  void replace(std::size_t accessor, Bytes bytes);

  /// A new accessor of the same type and number of elements, without data.
  std::size_t add_like(std::size_t accessor);

  std::uint64_t count(std::size_t accessor) const { return accessors_[accessor].count; }
  /// Components of one element: 1 to 4, more for matrices.
  int components(std::size_t accessor) const { return accessors_[accessor].components; }
  Component component(std::size_t accessor) const { return accessors_[accessor].component; }
  /// True after replace().
  bool replaced(std::size_t accessor) const { return accessors_[accessor].replaced; }
  /// True if the file holds data for the accessor.
  bool stored(std::size_t accessor) const { return accessors_[accessor].base || accessors_[accessor].sparse; }

  /// Throws SceneError at `path` (where the accessor is referred to) unless its type fits the use, or when
  /// its data is not in the file.
  void check_use(std::size_t accessor, AccessorUse use, const std::string& path) const;
  /// The first half of check_use: only the type.
  void check_type(std::size_t accessor, AccessorUse use, const std::string& path) const;
  /// The bytes of a buffer view; empty where they are not in the file.
  std::span<const unsigned char> view(std::size_t index) const { return views_[index]; }

  /// All elements, count * components floats; normalised integers become -1..1 or 0..1, exactly rounded.
  /// Throws SceneError at `path` for the first one that is not finite and for more elements than the import's memory
  /// holds, and at the accessor for bad sparse indices.
  std::vector<float> floats(std::size_t accessor, const std::string& path) const;
  /// The last element of a scalar accessor, as floats() gives it; 0 where the file has no data for it.
  double last_scalar(std::size_t accessor) const;
  /// All elements of an integer accessor. Throws SceneError at `path` as floats() does.
  std::vector<std::uint32_t> integers(std::size_t accessor, const std::string& path) const;

 private:
  /// Elements `stride` bytes apart; null if the data is not in the file.
  struct Strided {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
  };
  struct Sparse {
    std::uint64_t count = 0;
    Component index_component = Component::kUnsignedInt;
    Strided indices, values;
  };
  struct Accessor {
    std::uint64_t count = 0;
    Component component = Component::kFloat;
    std::string type;
    int components = 1;
    bool normalized = false;
    std::optional<Strided> base;
    std::optional<Sparse> sparse;
    std::vector<std::size_t> views;  ///< every buffer view it reads
    bool replaced = false;
  };

  Accessor parse(const Json& json, const std::string& path) const;
  Strided locate(std::size_t view, std::uint64_t offset, std::uint64_t count, std::size_t element_size, bool may_stride,
                 const std::string& path) const;
  std::vector<std::uint32_t> sparse_indices(std::size_t accessor) const;
  template <class T, class Convert>
  std::vector<T> read(std::size_t accessor, const std::string& path, const Convert& convert) const;

  const GltfDocument& document_;
  const ImportBudget& budget_;
  std::vector<std::span<const unsigned char>> views_;  ///< one a buffer view; empty: without data
  std::deque<Bytes> replacements_;
  std::vector<Accessor> accessors_;
  bool quantized_ = false;  ///< KHR_mesh_quantization is used
};

}  // namespace carousel::scene
