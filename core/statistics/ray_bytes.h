#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Traffic of the stacks of a resource's rays (`topology.shape: independent`).
struct StackTraffic {
  std::uint64_t pushed_bytes = 0, popped_bytes = 0, peak_bytes = 0, ray_peak_bytes = 0, spilled_bytes = 0,
                refilled_bytes = 0;

  static constexpr auto counters() {
    using C = StackTraffic;
    return std::array{
        Counter{"pushed_bytes", &C::pushed_bytes, "bytes", "bytes pushed: 4 for an inner node, 12 for a leaf"},
        Counter{"popped_bytes", &C::popped_bytes, "bytes", "bytes popped; rays left the rest when they ended early"},
        Counter{"peak_bytes", &C::peak_bytes, "bytes", "most bytes of all rays of the resource at one time"},
        Counter{"ray_peak_bytes", &C::ray_peak_bytes, "bytes", "most bytes of one ray at one time"},
        Counter{"spilled_bytes", &C::spilled_bytes, "bytes", "bytes of older entries written to memory"},
        Counter{"refilled_bytes", &C::refilled_bytes, "bytes", "bytes of them read back"},
    };
  }
  friend bool operator==(const StackTraffic&, const StackTraffic&) = default;
};

/// Bytes of the model-space rays that a resource keeps beside its records (`accuracy.transformed_ray: store`).
struct TransformedRayBytes {
  std::uint64_t written = 0, read = 0, peak = 0;

  static constexpr auto counters() {
    using C = TransformedRayBytes;
    return std::array{
        Counter{"written_bytes", &C::written, "bytes", "bytes written: 24 for each ray and instance"},
        Counter{"read_bytes", &C::read, "bytes", "bytes read at later visits"},
        Counter{"peak_bytes", &C::peak, "bytes", "most bytes kept at one time"},
    };
  }
  friend bool operator==(const TransformedRayBytes&, const TransformedRayBytes&) = default;
};

/// Data of rays and paths that ray control and shading have read from memory and written to it (`memory.ray_records`,
/// `path_state`, `film`, `sky_map`, `surfaces`, `shading.program`).
struct RayDataBytes {
  std::uint64_t records_read = 0, records_written = 0, states_read = 0, states_written = 0, film_read = 0,
                film_written = 0, sky_read = 0, materials_read = 0, vertices_read = 0, texels_read = 0, pages_read = 0,
                first_hits_read = 0;

  static constexpr auto counters() {
    using C = RayDataBytes;
    return std::array{
        Counter{"records_read", &C::records_read, "bytes", "master copies of rays read before the rays were loaded"},
        Counter{"records_written", &C::records_written, "bytes",
                "master copies of rays written, when they were given slots and when they were complete"},
        Counter{"states_read", &C::states_read, "bytes", "states of paths read before their rays were shaded"},
        Counter{"states_written", &C::states_written, "bytes", "states of paths written with new rays"},
        Counter{"film_read", &C::film_read, "bytes", "pixels read to add the light of a path"},
        Counter{"film_written", &C::film_written, "bytes", "pixels written"},
        Counter{"sky_read", &C::sky_read, "bytes",
                "texels and tables of the map of the sky read before rays were shaded"},
        Counter{"materials_read", &C::materials_read, "bytes", "materials read by shader workers"},
        Counter{"vertices_read", &C::vertices_read, "bytes", "vertices of triangles read likewise"},
        Counter{"texels_read", &C::texels_read, "bytes", "texels of textures read likewise"},
        Counter{"pages_read", &C::pages_read, "bytes", "entries of the page table read by walkers"},
        Counter{"first_hits_read", &C::first_hits_read, "bytes", "rasterised samples read before they are shaded"},
    };
  }
  friend bool operator==(const RayDataBytes&, const RayDataBytes&) = default;
};

}  // namespace carousel
