// Which element and component types each attribute may have: glTF 2.0 specification, 3.7.2.1, and the tables
// of KHR_mesh_quantization and EXT_mesh_gpu_instancing.
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
  struct Allowed {
    std::vector<std::string> types;
    bool floating, small_normalized, quantized_any, quantized_normalized;
  };
  // small_normalized: unsigned (colours, texture coordinates) or signed (rotations) bytes and shorts.
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
        return {{"VEC4"}, true, true, false, false};
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
  const bool core = use == AccessorUse::kIndices
                        ? !is_signed && accessor.component != Component::kFloat && !accessor.normalized
                        : (accessor.component == Component::kFloat && allowed.floating) ||
                              (is_small && accessor.normalized && allowed.small_normalized &&
                               is_signed == (use == AccessorUse::kRotation));
  // Normals are quantised to signed components only; positions and texture coordinates to any small one.
  const bool quantized = is_small && (use == AccessorUse::kNormal ? is_signed && accessor.normalized
                                      : accessor.normalized       ? allowed.quantized_normalized
                                                                  : allowed.quantized_any);
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
