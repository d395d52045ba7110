#pragma once

#include "report/run/report.h"

namespace carousel::report {

// As report/run/report_fields.h, for the sections `resources`.

template <class V>
void describe(V& v, Stalls& r) {
  v.field("credits", r.credits, "attempts", "no packet was free to issue with");
  v.field("link", r.link, "attempts", "the outgoing link was full");
  v.field("slots", r.slots, "attempts", "new rays waited for slots");
  v.field("storage", r.storage, "attempts", "too few collection blocks were free");
  v.field("reserve", r.reserve, "attempts", "the reserve was entered: one packet at a time, deepest first");
}

template <class V>
void describe(V& v, UnitCycles& r) {
  v.field("busy", r.busy, "cycles", "a test was started, or the units' interval kept one from starting");
  v.field("other_units", r.other_units, "cycles", "a packet was in test, in other units or on its way through");
  v.field("memory", r.memory, "cycles", "waiting for shape data");
  v.field("link", r.link, "cycles", "waiting for a packet to leave");
  v.field("credits", r.credits, "cycles", "all packets were out");
  v.field("storage", r.storage, "cycles", "too few collection blocks were free");
  v.field("shading", r.shading, "cycles", "helping the shader workers");
  v.field("idle", r.idle, "cycles", "nothing to test");
}

template <class V>
void describe(V& v, Units& r) {
  v.section("box", r.box, "testers of boxes");
  v.section("triangle", r.triangle, "testers of triangles");
  v.section("plane", r.plane, "testers of cull planes");
  v.section("bundle", r.bundle, "testers of bundles");
  v.section("ray_reads", r.ray_reads, "the port of the ray store, with rays.reads_per_cycle");
  v.section("procedural", r.procedural, "testers of procedural primitives");
  v.section("any_hit", r.any_hit, "where it is looked up what lets rays through, with testers.any_hit: inline");
  v.section("transform", r.transform, "transform units");
  v.field("handler_busy", r.handler_busy, "cycles", "looking through packets' IDs");
  v.field("handler_idle", r.handler_idle, "cycles", "the rest");
}

template <class V>
void describe(V& v, Stack& r) {
  v.field("pushed_bytes", r.pushed_bytes, "bytes", "4 for an inner node, 12 for a leaf");
  v.field("popped_bytes", r.popped_bytes, "bytes", "the rest was left by rays that needed no more");
  v.field("peak_bytes", r.peak_bytes, "bytes", "of all its rays at once");
  v.field("ray_peak_bytes", r.ray_peak_bytes, "bytes", "of one ray");
}

template <class V>
void describe(V& v, TransformedRays& r) {
  v.field("written_bytes", r.written_bytes, "bytes", "24 a ray and instance");
  v.field("read_bytes", r.read_bytes, "bytes", "at later visits");
  v.field("peak_bytes", r.peak_bytes, "bytes", "kept at once");
}

template <class V>
void describe(V& v, Resource& r) {
  v.field("resource", r.resource, "", "number of the resource");
  v.field("rays_admitted", r.rays_admitted, "IDs", "of rays, or of bundles of them, that joined its root collection");
  v.field("rays_completed", r.rays_completed, "rays", "handed over to shading");
  v.field("packets_issued", r.packets_issued, "packets", "from its collections");
  v.field("packets_retired", r.packets_retired, "packets", "of its own that came back");
  v.field("packets_seen", r.packets_seen, "packets", "looked at, its own and others'");
  v.field("bubbles", r.bubbles, "packets", "seen without a local ray");
  v.field("hops", r.hops, "packets", "sent on to a neighbour");
  v.field("rays_tested", r.rays_tested, "rays", "members of packets tested here");
  v.field("box_tests", r.box_tests, "tests", "ray against box");
  v.field("triangle_tests", r.triangle_tests, "tests", "ray against triangle");
  v.field("transforms", r.transforms, "rays", "brought to model space");
  v.field("collections_created", r.collections_created, "collections", "in all");
  v.field("collections_peak", r.collections_peak, "collections", "at once");
  v.field("memberships_peak", r.memberships_peak, "ray IDs", "in collections at once");
  v.field("spilled", r.spilled, "ray IDs", "stored beyond the capacity");
  v.section("stalls", r.stalls, "what could not proceed at once");
  v.section("units", r.units, "cycles of its units; each unit's add up to engine.cycles");
  v.section("stack", r.stack, "of its rays, with topology.shape: independent");
  v.section("transformed_rays", r.transformed_rays, "in model space, with accuracy.transformed_ray: store");
}

}  // namespace carousel::report
