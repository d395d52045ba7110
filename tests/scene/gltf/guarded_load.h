#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::scene {

/// The outcome of loading one damaged model.
struct LoadOutcome {
  enum class End { kLoaded, kRefused, kFault } end = End::kFault;
  std::string path, message;  ///< path and text of the SceneError; for a fault, a description

  bool operator==(const LoadOutcome&) const = default;
};
std::ostream& operator<<(std::ostream& out, const LoadOutcome& outcome);

/// True if load_guarded() limits memory; sanitizers need more than the limit themselves.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kMemoryIsGuarded = false;
#elif defined(__has_feature)
inline constexpr bool kMemoryIsGuarded = !__has_feature(address_sanitizer);
#else
inline constexpr bool kMemoryIsGuarded = true;
#endif

/// Calls `load` for 0 to count - 1 in a child process, so that a crash, a hang (more than `seconds`) or greed
/// (256 MiB more than the process holds already) becomes the outcome of the one model that caused it. `load`
/// damages model number i, the same way each time, and loads it.
///
/// kLoaded: a scene whose indices are in range. kRefused: a SceneError that has a message. kFault: anything
/// else, running out of memory included.
std::vector<LoadOutcome> load_guarded(std::size_t count, const std::function<Scene(std::size_t)>& load,
                                      unsigned seconds = 10);

}  // namespace carousel::scene
