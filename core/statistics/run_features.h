#pragma once

#include <cstdint>

namespace carousel {

/// The runs whose report shows a number.
enum class Shown : std::uint8_t {
  kAlways,      ///< every run
  kNever,       ///< no run: the number is only an ingredient of others
  kCullPlanes,  ///< runs with cull planes
  kBundles,     ///< runs with bundles of rays
  kProcedural,  ///< runs whose scene has procedural primitives
  kAnyHit,      ///< runs whose scene has primitives that are not opaque
  kAnyHitUnit,  ///< runs that look up the opacity of such primitives in units beside the testers
  kQuantised,   ///< runs with quantised nodes
  kMicromaps,   ///< runs that look primitives that are not opaque up in opacity micromaps first
  kNearest,     ///< runs whose rays look for several nearest hits
  kPrograms,    ///< runs whose scene has primitives with programs
  kBlocks,      ///< runs with compressed leaves
};

/// The features of a machine and its scene that decide which numbers its report shows.
struct RunFeatures {
  bool cull_planes = false, bundles = false, procedural = false, any_hit = false, any_hit_units = false,
       quantised = false, micromaps = false, nearest = false, programs = false, blocks = false;

  constexpr bool show(Shown shown) const {
    switch (shown) {
      case Shown::kAlways:
        return true;
      case Shown::kNever:
        return false;
      case Shown::kCullPlanes:
        return cull_planes;
      case Shown::kBundles:
        return bundles;
      case Shown::kProcedural:
        return procedural;
      case Shown::kAnyHit:
        return any_hit;
      case Shown::kAnyHitUnit:
        return any_hit_units;
      case Shown::kQuantised:
        return quantised;
      case Shown::kMicromaps:
        return micromaps;
      case Shown::kNearest:
        return nearest;
      case Shown::kPrograms:
        return programs;
      case Shown::kBlocks:
        return blocks;
    }
    return false;
  }
};

}  // namespace carousel
