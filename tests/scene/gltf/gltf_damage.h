#pragma once

#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/scene/gltf/model_files.h"

namespace carousel::scene {

using Json = nlohmann::json;

/// One way to break a model, and what the importer must say of it.
struct Damage {
  /// Where the fault lies, and a part of the message.
  struct Verdict {
    std::string path, message;
  };
  const char* name;
  /// Damages the model; nothing when it has no such part.
  std::function<std::optional<Verdict>(ModelFiles&)> plant;
};

/// Damage to the document itself, its nodes, and what hangs on nodes.
std::vector<Damage> structure_damages();
/// Damage to accessors, buffer views, buffers, images and the files they come from.
std::vector<Damage> data_damages();

/// Overwrites bytes of a file.
template <class T>
void put(char* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

}  // namespace carousel::scene
