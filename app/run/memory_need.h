#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/config/tree/positions.h"
#include "ringbus/protocol/memory_estimate.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// Estimate of the bytes that a run needs.
struct MemoryNeed {
  std::uint64_t scene = 0;
  std::uint64_t accel = 0;  ///< before the scene is loaded: including the memory of the build
  ringbus::MemoryEstimate ring;
  std::uint64_t paths = 0;  ///< states of the paths in flight
  std::uint64_t film = 0;   ///< including the pictures made from it
  std::uint64_t hits = 0;   ///< rows kept for hits.csv or a ray file, camera rays only

  std::uint64_t total() const { return scene + accel + ring.total() + paths + film + hits; }
};

/// The estimate before the scene is loaded: the configuration gives a built-in scene's size, but not a file's.
MemoryNeed estimate_before_scene(const Config& config, bool keep_hits);
/// The estimate with the loaded scene and its structure.
MemoryNeed estimate(const Config& config, bool keep_hits, const scene::Scene& scene, const accel::Accel& accel);

/// Bytes of a loaded scene.
std::uint64_t scene_bytes(const scene::Scene& scene);
/// Bytes that the build of a loaded scene's structure takes at its peak, the structure included.
std::uint64_t build_bytes(const scene::Scene& scene);

/// Number of paths with rays in flight at a time: one for each slot.
std::uint64_t paths_in_flight(const Config& config);

/// A readable text of several lines.
std::string memory_text(const MemoryNeed& need, std::uint64_t usable_bytes);

/// Throws a ConfigError at the key that weighs most unless the need is at most `usable_bytes`.
void require_fit(const MemoryNeed& need, std::uint64_t usable_bytes, const KeyPositions& positions);

}  // namespace carousel::app
