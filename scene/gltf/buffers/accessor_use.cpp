// Which element and component types each attribute may have: glTF 2.0 specification, 3.7.2.1, and the tables
// of KHR_mesh_quantization and EXT_mesh_gpu_instancing; 3.7.3 for skins, 3.11 for animations.
#include <algorithm>

#include "scene/gltf/buffers/accessor.h"

namespace carousel::scene {

const char* name_of(Component component) {
  switch (component) {
    case Component::kByte:
      return "BYTE";
    case Component::kUnsignedByte:
      return "UNSIGNED_BYTE";
    case Component::kShort:
      return "SHORT";
    case Component::kUnsignedShort:
      return "UNSIGNED_SHORT";
    case Component::kUnsignedInt:
      return "UNSIGNED_INT";
    case Component::kFloat:
      return "FLOAT";
  }
  return "?";
}

void AccessorTable::check_type(std::size_t index, AccessorUse use, const std::string& path) const {
  const Accessor& accessor = accessors_[index];
  enum class Signs { kUnsigned, kSigned, kBoth };
  struct Allowed {
    std::vector<std::string> types;
    bool floating, small_normalized, quantized_any, quantized_normalized;
    Signs signs = Signs::kUnsigned;  ///< of normalised bytes and shorts
  };
  const auto allowed = [&]() -> Allowed {
    switch (use) {
      case AccessorUse::kPosition:
        return {{"VEC3"}, true, false, true, true};
      case AccessorUse::kNormal:
        return {{"VEC3"}, true, false, false, true};
      case AccessorUse::kTexCoord:
        return {{"VEC2"}, true, true, true, true};
      case AccessorUse::kColor:
        return {{"VEC3", "VEC4"}, true, true, false, false};
      case AccessorUse::kTranslation:
      case AccessorUse::kScale:
        return {{"VEC3"}, true, false, false, false};
      case AccessorUse::kRotation:
        return {{"VEC4"}, true, true, false, false, Signs::kSigned};
      case AccessorUse::kTurn:
        return {{"VEC4"}, true, true, false, false, Signs::kBoth};
      case AccessorUse::kMorphWeight:
        return {{"SCALAR"}, true, true, false, false, Signs::kBoth};
      case AccessorUse::kOpacity:
        return {{"SCALAR"}, true, true, false, false};
      case AccessorUse::kTime:
        return {{"SCALAR"}, true, false, false, false};
      case AccessorUse::kMorphPosition:
        return {{"VEC3"}, true, false, true, true};
      case AccessorUse::kMorphNormal:
        return {{"VEC3"}, true, false, false, true};
      case AccessorUse::kJoints:
        return {{"VEC4"}, false, false, false, false};
      case AccessorUse::kSkinWeights:
        return {{"VEC4"}, true, true, false, false};
      case AccessorUse::kInverseBind:
        return {{"MAT4"}, true, false, false, false};
      case AccessorUse::kIndices:
        return {{"SCALAR"}, false, false, false, false};
    }
    return {};
  }();
  const bool is_signed = accessor.component == Component::kByte || accessor.component == Component::kShort;
  const bool is_small = size_of(accessor.component) < 4;
  const std::string found = "accessor " + std::to_string(index) + " has " + (accessor.normalized ? "normalised " : "") +
                            accessor.type + " of " + name_of(accessor.component);
  if (std::ranges::find(allowed.types, accessor.type) == allowed.types.end()) {
    document_.fail(path, "expected " + allowed.types[0] + (allowed.types.size() > 1 ? " or " + allowed.types[1] : "") +
                             " elements; " + found);
  }
  const bool whole = !is_signed && accessor.component != Component::kFloat && !accessor.normalized;
  const bool core = use == AccessorUse::kIndices ? whole
                    : use == AccessorUse::kJoints
                        ? whole && is_small
                        : (accessor.component == Component::kFloat && allowed.floating) ||
                              (is_small && accessor.normalized && allowed.small_normalized &&
                               (allowed.signs == Signs::kBoth || is_signed == (allowed.signs == Signs::kSigned)));
  // Normals and differences are quantised to signed components only; positions and texture coordinates to any small
  // one.
  const bool only_signed =
      use == AccessorUse::kNormal || use == AccessorUse::kMorphPosition || use == AccessorUse::kMorphNormal;
  const bool quantized = is_small && (is_signed || !only_signed) &&
                         (accessor.normalized ? allowed.quantized_normalized : allowed.quantized_any);
  if (!core && !(quantized && quantized_)) {
    document_.fail(path, quantized ? found + ", which needs the extension KHR_mesh_quantization"
                                   : "the component type is not allowed here: " + found);
  }
}

void AccessorTable::check_use(std::size_t index, AccessorUse use, const std::string& path) const {
  check_type(index, use, path);
  const Accessor& accessor = accessors_[index];
  for (const std::size_t view : accessor.views) {
    if (views_[view].empty()) {
      document_.fail(path, "the data of accessor " + std::to_string(index) + " is not in the file: buffer " +
                               document_.json["bufferViews"][view]["buffer"].dump() + " holds none");
    }
  }
}

}  // namespace carousel::scene
