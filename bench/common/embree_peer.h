#pragma once

#include <memory>
#include <string>

#include "bench/common/ray_sets.h"
#include "scene/model/scene.h"

namespace carousel::bench {

enum class EmbreeQuality { kMedium, kHigh };  ///< high: spatial splits, its best tree

struct EmbreeSettings {
  bool robust = false;
  EmbreeQuality quality = EmbreeQuality::kHigh;
  std::string frequency_level = "simd256";  ///< the instruction sets that it may use
  int build_threads = 1;
};

/// A scene in Embree 3. Meshes placed once are brought into world space; meshes placed several times are instanced.
class EmbreePeer {
 public:
  /// Throws std::runtime_error with Embree's own message.
  EmbreePeer(const scene::Scene& scene, const EmbreeSettings& settings);
  ~EmbreePeer();
  EmbreePeer(EmbreePeer&&) noexcept;

  double build_seconds() const;
  /// Memory that Embree holds after the build, its copies of vertices and indices included.
  std::size_t size_bytes() const;

  /// rtcIntersect1, or rtcOccluded1 for any-hit sets, on `threads` threads. For an occluded ray only Hit::instance is
  /// set.
  void trace_single(const RaySet& rays, int threads, HitList& hits) const;
  /// rtcIntersect16 or rtcOccluded16, with the flag for coherent rays if they are.
  void trace_sixteen(const RaySet& rays, int threads, HitList& hits) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace carousel::bench
