#pragma once

#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/scene/gltf/model_files.h"

namespace carousel::scene {

using Json = nlohmann::json;

/// One way to break a model, and the importer's expected error.
struct Damage {
  /// Place of the fault, and a part of the message.
  struct Verdict {
    std::string path, message;
  };
  const char* name;
  /// Damages the model; empty if it has no such part.
  std::function<std::optional<Verdict>(ModelFiles&)> plant;
};

/// Damage to the document itself, its nodes, and the objects that nodes refer to.
std::vector<Damage> structure_damages();
/// Damage to accessors, buffer views, buffers, images and the files they come from.
std::vector<Damage> data_damages();

/// Overwrites bytes of a file.
template <class T>
void put(char* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

}  // namespace carousel::scene
