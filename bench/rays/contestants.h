#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "accel/traverse/reference_tracer.h"
#include "bench/common/embree_peer.h"
#include "bench/common/ray_sets.h"
#include "bench/common/results.h"
#include "bench/common/ring_runner.h"
#include "scene/model/scene.h"

namespace carousel::bench {

/// Names that other contestants are compared with.
inline constexpr const char* kDepthFirst = "depth-first";
inline constexpr const char* kDepthFirstInterleaved = "depth-first, interleaved";
inline constexpr const char* kEmbreeRobust = "Embree robust, single";
/// Names that the summary picks out.
inline constexpr const char* kTreeletLocal = "ring treelet, local";
inline constexpr const char* kTreeletOwners = "ring treelet, 2 owners";

/// A tracer of ray sets that is measured.
struct Contestant {
  std::string name;
  bool ours = true;  ///< part of Carousel, whose hits must equal the reference to the bit; others may differ in a few
  std::function<Work(const RaySet& rays, int threads, HitList& hits)> trace;
};

/// The choice of contestants.
struct Field {
  bool all_forms = false;  ///< the ring's other traversals, eight resources and statistics, and Embree 16-wide
  std::vector<std::string> variations;  ///< both treelet rings again with these changes (with_changes())
  std::string only;                     ///< if not empty: only contestants whose name contains this text
  EmbreeQuality quality = EmbreeQuality::kHigh;
  std::string frequency_level = "simd256";
};

/// A scene ready to be traced, and its contestants.
class Contest {
 public:
  /// Builds Embree's scenes if Embree takes part. Keeps references.
  Contest(const scene::Scene& scene, const accel::Accel& accel, const RingSettings& ring, const Field& field);

  const std::vector<Contestant>& contestants() const { return contestants_; }

 private:
  void add(Contestant contestant);
  void add_depth_first(const char* name, decltype(accel::trace_depth_first)& trace);
  void add_ring(const std::string& name, const RingSettings& settings, const RingForm& form, bool resource_a_thread);
  void add_treelet_rings(const std::string& suffix, const RingSettings& settings, bool statistics);
  void add_embree(const scene::Scene& scene, bool robust);

  const accel::Accel& accel_;
  Field field_;
  float scene_size_;
  std::vector<Contestant> contestants_;
};

/// Length of the diagonal of the scene's bounds.
float scene_size(const scene::Scene& scene);

}  // namespace carousel::bench
