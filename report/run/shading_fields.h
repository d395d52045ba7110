#pragma once

#include "report/run/report.h"

namespace carousel::report {

// As report/run/report_fields.h, for the section `shading`.

template <class V>
void describe(V& v, EffectCost& r) {
  v.field("rays", r.rays, "rays", "of a path, at most");
  v.field("texture_reads", r.texture_reads, "lookups", "filtered, at a hit, at most");
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "of a path in flight");
  v.field("cycles_per_hit", r.cycles_per_hit, "cycles",
          "modelled, of a shader worker or opacity unit where a surface has it");
  v.field("cycles_per_path", r.cycles_per_path, "cycles",
          "modelled, of shader workers for those rays, at most; their tests come on top");
}

template <class V>
void describe(V& v, Effect& r) {
  v.field("name", r.name, "", "name of the effect");
  v.field("on", r.on, "", "whether it was computed");
  v.field("called_for", r.called_for, "", "whether the scene calls for it");
  v.field("callers", r.callers, "callers", "materials, meshes or lights that do");
  v.field("why", r.why, "", "what called for it, or that nothing did");
  v.section("cost", r.cost, "what it costs where it occurs; zero if it is off");
}

template <class V>
void describe(V& v, ShaderClass& r) {
  v.field("name", r.name, "",
          "unlit, plain, textured, layered, opaque (other boundaries than glTF's core), transmissive, or anything");
  v.field("materials", r.materials, "materials", "shaded by code for this");
}

template <class V>
void describe(V& v, EffectsSaved& r) {
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "of a path in flight, that all effects would take besides");
  v.field("images_not_decoded", r.images_not_decoded, "images", "that no effect reads");
}

template <class V>
void describe(V& v, EffectsProof& r) {
  v.field("same_hits", r.same_hits, "", "digest.hits is the same");
  v.field("same_image", r.same_image, "", "digest.image is the same");
  v.field("rays_spared", r.rays_spared, "rays", "that all effects would have sent besides");
  v.field("tests_spared", r.tests_spared, "tests",
          "box, triangle, procedural, plane and bundle tests; on the native engine they vary by timing");
  v.field("cycles_spared", r.cycles_spared, "cycles", "of the simulated machine");
}

template <class V>
void describe(V& v, Shading& r) {
  v.field("workers", r.workers, "workers", "shader workers");
  v.field("shaded", r.shaded, "rays", "completed rays shaded");
  v.field("saturated", r.saturated, "values", "radiance values beyond the range of fixed point");
  v.field("utilisation", r.utilisation, "fraction", "of the workers' cycles, those spent on shading and camera rays");
  v.section("effects", r.effects, "effects of light");
  v.field("effects_choice", r.effects_choice, "",
          "shading.effects: auto, all, or the list; a list changes digest.image");
  v.field("path_state_bytes", r.path_state_bytes, "bytes", "of a path in flight");
  v.section("saved", r.saved, "what effects that are off did not take");
  v.section("proof", r.proof, "the same run with all effects, with verify: effects");
  v.section("classes", r.classes, "materials on triangles, by the code that shades them");
}

}  // namespace carousel::report
