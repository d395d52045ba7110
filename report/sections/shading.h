#pragma once

#include "core/statistics/shading_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

struct EffectCost {
  std::uint64_t rays = 0, texture_reads = 0, products = 0, path_state_bytes = 0, cycles_per_hit = 0,
                cycles_per_path = 0;
};

template <class V>
void describe(V& v, const EffectCost& r) {
  v.field("rays", r.rays, "rays", "most rays that the effect adds to a path");
  v.field("texture_reads", r.texture_reads, "lookups", "most filtered texture lookups at a hit");
  v.field("products", r.products, "products", "most products of the shader at a hit, beyond those of a plain surface");
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "state of a path in flight");
  v.field("cycles_per_hit", r.cycles_per_hit, "cycles",
          "modelled cycles of a shader worker or opacity unit at a surface with the effect");
  v.field("cycles_per_path", r.cycles_per_path, "cycles",
          "most modelled cycles of shader workers for the rays added to a path, without their tests");
}

struct Effect {
  std::string name;
  bool on = false, called_for = false;
  std::uint64_t callers = 0;
  std::string why;
  EffectCost cost;
};

template <class V>
void describe(V& v, const Effect& r) {
  v.field("name", r.name, "", "name of the effect");
  v.field("on", r.on, "", "true if the effect was computed");
  v.field("called_for", r.called_for, "", "true if the scene requires the effect");
  v.field("callers", r.callers, "callers", "materials, meshes or lights that require the effect");
  v.field("why", r.why, "", "reason why the effect is required, or that nothing requires it");
  v.section("cost", r.cost, "cost of the effect where it occurs; zero if it is off");
}

struct ShaderClass {
  std::string name;
  std::uint64_t materials = 0;
};

template <class V>
void describe(V& v, const ShaderClass& r) {
  v.field("name", r.name, "",
          "unlit, plain, textured, layered, opaque (other boundaries than glTF's core), transmissive, or anything");
  v.field("materials", r.materials, "materials", "materials shaded by the code of this class");
}

struct EffectsSaved {
  std::uint64_t path_state_bytes = 0, images_not_decoded = 0;
};

template <class V>
void describe(V& v, const EffectsSaved& r) {
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "state of a path in flight that only disabled effects need");
  v.field("images_not_decoded", r.images_not_decoded, "images", "images that no enabled effect reads");
}

/// A measurement over paired repetitions.
struct PairedTimes {
  double median = 0, least = 0, most = 0;
};

template <class V>
void describe(V& v, const PairedTimes& r) {
  v.field("median", r.median, "s", "median of the repetitions");
  v.field("least", r.least, "s", "least of them");
  v.field("most", r.most, "s", "greatest of them");
}

/// all over auto, in each pair of repetitions.
struct PairedRatio {
  double median = 0, least = 0, most = 0;
};

template <class V>
void describe(V& v, const PairedRatio& r) {
  v.field("median", r.median, "ratio", "median of the pairs");
  v.field("least", r.least, "ratio", "least of them");
  v.field("most", r.most, "ratio", "greatest of them");
}

/// The time, memory and work of the frame with effects by demand and with all of them.
struct EffectsUse {
  PairedTimes seconds{};
  double products_per_ray = 0;
  std::uint64_t path_state_bytes = 0, texture_bytes = 0;
  std::optional<std::uint64_t> cycles{};
};

template <class V>
void describe(V& v, const EffectsUse& r) {
  v.section("seconds", r.seconds,
            "CPU time of the sample of paths, traced depth first and shaded on one thread; repeated in turn");
  v.field("products_per_ray", r.products_per_ray, "products",
          "products of the shader for effects, beyond those of plain surfaces, a completed ray of the sample");
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "state of all paths in flight");
  v.field("texture_bytes", r.texture_bytes, "bytes", "decoded images");
  v.field("cycles", r.cycles, "cycles", "cycles of the simulated machine for the frame");
}

/// The outcome of `verify: effects`.
struct EffectsProof {
  bool same_hits = false, same_image = false;
  std::uint64_t paths = 0, repetitions = 0;
  EffectsUse by_demand{}, all{};
  PairedRatio time_ratio{};
};

template <class V>
void describe(V& v, const EffectsProof& r) {
  v.field("same_hits", r.same_hits, "", "true if digest.hits is the same");
  v.field("same_image", r.same_image, "", "true if digest.image is the same");
  v.field("paths", r.paths, "paths", "sample of the frame's paths that is timed");
  v.field("repetitions", r.repetitions, "repetitions", "timed repetitions of each, in turn");
  v.section("auto", r.by_demand, "effects by demand: shading.effects: auto");
  v.section("all", r.all, "shading.effects: all");
  v.section("time_ratio", r.time_ratio, "time with all over time with auto, in each pair of repetitions");
}

/// The vectors of shader workers with several lanes.
struct ShadeVectors {
  ShadeVectorCounts counts;
  double fill = 0, shaders = 0;
};

template <class V>
void describe(V& v, const ShadeVectors& r) {
  describe(v, r.counts);
  v.field("fill", r.fill, "fraction",
          "fraction of the lanes that had a ray in a pass; a vector takes a pass for each of its different shaders");
  v.field("shaders", r.shaders, "shaders", "mean of the different shaders of a vector, which run one after the other");
}

/// The programs of shader workers (`shading.program`).
struct ShaderPrograms {
  ShadeProgramCounts counts;
  std::uint64_t registers = 0, vectors_held = 0, store_bytes = 0;
  std::optional<double> occupancy{}, lane_fill{}, issue_rate{};
  std::optional<ShadeDataCounts> data{};
};

template <class V>
void describe(V& v, const ShaderPrograms& r) {
  v.field("registers", r.registers, "registers", "registers of a ray, those of the largest program");
  v.field("vectors_held", r.vectors_held, "vectors", "vectors that the registers of a worker hold at most");
  v.field("store_bytes", r.store_bytes, "bytes", "instructions of all programs");
  v.field("occupancy", r.occupancy, "fraction", "vectors that a worker held in its mean working cycle, of the most");
  v.field("lane_fill", r.lane_fill, "fraction",
          "lanes that had a ray at the instruction, of those of all instructions issued");
  v.field("issue_rate", r.issue_rate, "instructions/cycle",
          "instructions that a worker issued in its mean working cycle");
  describe(v, r.counts);
  v.section("data", r.data, "data caches and TLBs of the workers, with shading.data_cache or shading.translation");
}

/// One of several pools of shader workers that a graph draws.
struct WorkerPool {
  std::string name;
  std::uint64_t resources = 0, workers = 0, shaded = 0;
  double utilisation = 0;
};

template <class V>
void describe(V& v, const WorkerPool& r) {
  v.field("name", r.name, "", "its node in topology.nodes");
  v.field("resources", r.resources, "resources", "resources whose rays it shades");
  v.field("workers", r.workers, "workers", "its workers");
  v.field("shaded", r.shaded, "rays", "completed rays that it shaded");
  v.field("utilisation", r.utilisation, "fraction", "as that of all workers");
}

struct Shading {
  std::uint64_t workers = 0, shaded = 0, saturated = 0;
  std::optional<double> utilisation{};
  std::optional<std::uint64_t> products{}, lookups{};
  std::vector<Effect> effects{};
  std::string effects_choice{};
  std::uint64_t path_state_bytes = 0;
  EffectsSaved saved{};
  std::vector<ShaderClass> classes{};
  std::optional<ShadeVectors> vectors{};
  std::optional<ShaderPrograms> programs{};
  std::optional<EffectsProof> proof{};
  std::optional<std::vector<WorkerPool>> pools{};
};

template <class V>
void describe(V& v, const Shading& r) {
  v.field("workers", r.workers, "workers", "shader workers");
  v.field("shaded", r.shaded, "rays", "completed rays shaded");
  v.field("saturated", r.saturated, "values", "radiance values beyond the range of fixed point");
  v.field("utilisation", r.utilisation, "fraction",
          "fraction of the workers' cycles spent on shading and on making camera rays; with programs, those in which "
          "they held any rays");
  v.field("products", r.products, "products",
          "products of the surfaces' effects, beyond those of plain surfaces, without shading.program (cycle)");
  v.field("lookups", r.lookups, "lookups", "filtered texture lookups at surfaces, without shading.program (cycle)");
  v.section("pools", r.pools,
            "the pools of workers, where several are drawn; they add up to the numbers above (cycle)");
  v.section("vectors", r.vectors, "vectors of the workers, with shading.lanes (cycle)");
  v.section("programs", r.programs, "the programs of the workers, with shading.program (cycle)");
  v.section("effects", r.effects, "every effect of light");
  v.field("effects_choice", r.effects_choice, "",
          "shading.effects: auto, all, or the list; a list changes digest.image");
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "state of a path in flight");
  v.section("saved", r.saved, "memory not needed because effects are off");
  v.section("proof", r.proof, "comparison with a run with all effects, with verify: effects");
  v.section("classes", r.classes, "materials of triangles by the code that shades them");
}

/// The cycles that the effects plan spares: what the same frame would take if the shaders computed all effects of light
/// at every surface (`shading.effects: all`). A forecast from the table of products, and with `verify: effects` the
/// cycles that a second run took.
struct EffectsSpared {
  double products_per_ray = 0;
  std::uint64_t shader_cycles = 0, cycles_with_all = 0, low = 0, high = 0;
  double fraction = 0;
  std::optional<std::uint64_t> measured{};
  std::optional<double> error{};
};

template <class V>
void describe(V& v, const EffectsSpared& r) {
  v.field("products_per_ray", r.products_per_ray, "products",
          "products of the shader for each completed ray that all effects would need more");
  v.field("shader_cycles", r.shader_cycles, "cycles", "cycles of all shader workers together that these would take");
  v.field("cycles_with_all", r.cycles_with_all, "cycles", "forecast of the cycles of the frame with all effects");
  v.field("low", r.low, "cycles", "the least that it can be: shaders work beside all other parts");
  v.field("high", r.high, "cycles", "the most that is expected: all parts wait while shaders work longer");
  v.field("fraction", r.fraction, "fraction", "part of the forecast cycles that the plan spared");
  v.field("measured", r.measured, "cycles", "cycles of the frame with all effects, with verify: effects");
  v.field("error", r.error, "fraction", "forecast over the measured cycles, less one");
}

/// The choice of effects, and what it was worth.
struct Effects {
  std::optional<EffectsSpared> spared{};
};

template <class V>
void describe(V& v, const Effects& r) {
  v.section("spared", r.spared, "cycles spared, by forecast; absent if a list leaves effects out");
}

}  // namespace carousel::report
