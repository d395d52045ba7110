#pragma once

#include <algorithm>
#include <cstddef>

#include <glm/common.hpp>

#include "core/types/vec.h"
#include "scene/gltf/document/document.h"

namespace carousel::scene {

// Numbers of JSON objects that have passed check_schema; `fallback` where the key is absent.

inline float number_in(const Json& object, const char* key, float fallback) {
  return object.value(key, fallback);
}

/// Moved into [0, 1].
inline float unit_in(const Json& object, const char* key, float fallback) {
  return std::clamp(number_in(object, key, fallback), 0.0f, 1.0f);
}

inline float at_least(float least, const Json& object, const char* key, float fallback) {
  return std::max(number_in(object, key, fallback), least);
}

/// V has as many components as the schema demands of the array.
template <class V>
V vector_in(const Json& object, const char* key, const V& fallback) {
  const auto entry = object.find(key);
  if (entry == object.end()) return fallback;
  V out;
  for (int c = 0; c < V::length(); ++c) out[c] = (*entry)[static_cast<std::size_t>(c)].template get<float>();
  return out;
}

}  // namespace carousel::scene
