#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The work of testing rays. A test is one box, triangle, procedural primitive, plane or bundle against one ray (or
/// bundle of rays). Meanings stand in counters(); core/statistics/counters.h says how to add a counter.
struct IntersectionCounts {
  std::uint64_t box = 0, triangle = 0, procedural = 0, plane = 0, bundle = 0, transforms = 0;
  std::uint64_t any_hit_calls = 0, culled = 0, inversions = 0, exact_volumes = 0, refined = 0, transforms_in_double = 0;
  std::uint64_t full_inversions = 0, extra_box_hits = 0, micromap_lookups = 0, micromap_known = 0, buffer_steps = 0,
                decoded = 0;
  std::uint64_t programs = 0, program_cycles = 0;
  std::uint64_t silhouettes = 0, edges = 0, reciprocals = 0, inversions_in_double = 0;
  std::uint64_t simple_instructions = 0, product_instructions = 0, divide_instructions = 0, branch_instructions = 0;

  static constexpr auto counters() {
    using C = IntersectionCounts;
    return std::array{
        Counter{"box", &C::box, "tests", "tests of a ray against a box"},
        Counter{"plane", &C::plane, "tests", "tests of a ray against a cull plane"},
        Counter{"triangle", &C::triangle, "tests", "tests of a ray against a triangle"},
        Counter{"refined", &C::refined, "tests",
                "triangles that a ray met in 32 bits and whose distance was computed in 64, with accuracy.triangle: "
                "watertight"},
        Counter{"bundle", &C::bundle, "tests", "tests of a bundle of rays against a box, or the box of a primitive"},
        Counter{"silhouettes", &C::silhouettes, "tests",
                "those of the bundles' tests that were made by the silhouette of a box", Shown::kBundles},
        Counter{"edges", &C::edges, "edges", "edges of silhouettes that bundles were tested against", Shown::kBundles},
        Counter{
            "reciprocals", &C::reciprocals, "divisions",
            "divisions for bundles: six for the directions of one that is tested by intervals at a node, and one for "
            "the distance of each box to which a bundle goes on by its silhouette",
            Shown::kBundles},
        Counter{"transforms", &C::transforms, "tests", "transformations of a ray from world to model space"},
        Counter{"transforms_in_double", &C::transforms_in_double, "tests",
                "those of the transformations that are made in 64 bits because the instance's matrix is nearly "
                "singular"},
        Counter{"inversions", &C::inversions, "tests",
                "inversions of an instance's matrix at a visit, with accuracy.invert: visit"},
        Counter{"full_inversions", &C::full_inversions, "tests",
                "those of the inversions that computed the inverse of the whole matrix, translation and all, with "
                "accuracy.transform: inverse_matrix"},
        Counter{"inversions_in_double", &C::inversions_in_double, "tests",
                "those of the inversions that are made in 64 bits because the matrix is nearly singular"},
        Counter{"exact_volumes", &C::exact_volumes, "volumes",
                "volumes that accuracy.triangle: exact computed in exact arithmetic, as doubles did not decide: four a "
                "triangle test at most"},
        Counter{"extra_box_hits", &C::extra_box_hits, "tests",
                "boxes of bvh.storage: quantised that a ray hits, though it misses the full box", Shown::kQuantised},
        Counter{"culled", &C::culled, "tests",
                "children whose box the ray hits and which a cull plane showed to be missed"},
        Counter{"procedural", &C::procedural, "tests",
                "tests of a ray against a procedural primitive; only if the scene has any", Shown::kProcedural},
        Counter{"programs", &C::programs, "tests",
                "those of the tests of procedural primitives that ran a program, of primitives", Shown::kPrograms},
        Counter{"program_cycles", &C::program_cycles, "cycles",
                "time of these programs in a unit, by the latencies of programs", Shown::kPrograms},
        Counter{"simple_instructions", &C::simple_instructions, "instructions",
                "instructions of programs: sums, comparisons, moves, loads and reported hits", Shown::kPrograms},
        Counter{"product_instructions", &C::product_instructions, "instructions", "likewise, mul and fma",
                Shown::kPrograms},
        Counter{"divide_instructions", &C::divide_instructions, "instructions", "likewise, div and sqrt",
                Shown::kPrograms},
        Counter{"branch_instructions", &C::branch_instructions, "instructions",
                "likewise, if, else, loop, end, break and stop", Shown::kPrograms},
        Counter{"any_hit", &C::any_hit_calls, "tests",
                "any-hit calls: lookups of the opacity of a primitive that is not opaque; only if the scene has any",
                Shown::kAnyHit},
        Counter{"micromap", &C::micromap_lookups, "tests",
                "lookups in the opacity micromap of a triangle that is not opaque; only with bvh.micromaps",
                Shown::kMicromaps},
        Counter{"micromap_known", &C::micromap_known, "tests",
                "those of the lookups that found opaque or transparent: any-hit calls that were saved",
                Shown::kMicromaps},
        Counter{"buffer_steps", &C::buffer_steps, "steps",
                "comparisons of a hit with those in a ray's sorted buffer, each with a shift, with rays.query.nearest",
                Shown::kNearest},
        Counter{"decoded", &C::decoded, "blocks",
                "compressed blocks decoded: by a visit once for all of its rays, but once for each ray that goes "
                "through a subtree or the whole tree by itself",
                Shown::kBlocks},
    };
  }
  /// The counters above that are tests; a new kind of test belongs here too.
  constexpr std::uint64_t tests() const { return box + plane + triangle + procedural + bundle; }
  friend bool operator==(const IntersectionCounts&, const IntersectionCounts&) = default;
};

}  // namespace carousel
