#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// Triangles, or micro-triangles, by what is known of their opacity.
struct OpacityStates {
  std::uint64_t opaque = 0, transparent = 0, unknown = 0;
};

template <class V>
void describe(V& v, const OpacityStates& r) {
  v.field("opaque", r.opaque, "count", "those that every ray stops at");
  v.field("transparent", r.transparent, "count", "those that every ray passes");
  v.field("unknown", r.unknown, "count", "those for which the any-hit call decides");
}

/// Opacity micromaps of the triangles that are not opaque.
struct Micromaps {
  std::uint64_t bytes = 0, maps = 0, map_bytes = 0, micro_triangles_each = 0;
  OpacityStates triangles{}, micro_triangles{};
  std::uint64_t lookups = 0, calls_saved = 0, calls = 0;
  double saved_share = 0;
};

template <class V>
void describe(V& v, const Micromaps& r) {
  v.field("bytes", r.bytes, "bytes",
          "indices of 4 bytes and maps, each counted once; in the machine they stand behind their triangles");
  v.field("maps", r.maps, "triangles", "triangles that have a map");
  v.field("map_bytes", r.map_bytes, "bytes", "size of a map");
  v.field("micro_triangles_each", r.micro_triangles_each, "micro-triangles", "those of a map");
  v.section("triangles", r.triangles, "triangles whose index tells their state, without a map");
  v.section("micro_triangles", r.micro_triangles, "micro-triangles of all maps");
  v.field("lookups", r.lookups, "lookups", "hits that were looked up");
  v.field("calls_saved", r.calls_saved, "calls", "lookups that found opaque or transparent");
  v.field("calls", r.calls, "calls",
          "any-hit calls that were made all the same: of unknown states, of spheres, and of rays that report all hits");
  v.field("saved_share", r.saved_share, "fraction", "share of the saved calls in these and the saved ones");
}

}  // namespace carousel::report
