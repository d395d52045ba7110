#pragma once

#include <array>

#include "report/schema/checksum.h"
#include "report/schema/document_version.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// A ray by its place in the frame.
struct RayName {
  std::uint64_t x = 0, y = 0, sample = 0, bounce = 0, index = 0;
  std::string kind;
};

template <class V>
void describe(V& v, const RayName& r) {
  v.field("x", r.x, "pixels", "column of the pixel, from the left; of a ray of a list its number");
  v.field("y", r.y, "pixels", "row of the pixel, from the top");
  v.field("sample", r.sample, "", "sample of the pixel");
  v.field("bounce", r.bounce, "",
          "surfaces that the path met before; a shadow ray has the bounce of the surface it leaves");
  v.field("index", r.index, "",
          "of a shadow ray that goes on behind panes, the panes that it has passed; 0 for others");
  v.field("kind", r.kind, "", "camera, bounce or shadow");
}

/// A stretch of time in one stage.
struct RaySpan {
  double begin = 0, length = 0;
  std::string stage, part;
  std::optional<std::uint64_t> packet{};
  std::optional<std::string> node{};
};

template <class V>
void describe(V& v, const RaySpan& r) {
  v.field("begin", r.begin, "cycles|seconds", "time of the run");
  v.field("length", r.length, "cycles|seconds", "time in the stage; those of all spans add up to latency");
  v.field("stage", r.stage, "", "its stage; of several at once, as a member of several collections, the furthest");
  v.field("part", r.part, "", "resource N or link N; empty: ray control and shading");
  v.field("packet", r.packet, "", "packet that it was a member of");
  v.field("node", r.node, "", "node of the tree that it waited for or was tested with");
}

struct RayStageSum {
  std::string stage;
  double length = 0, share = 0;
  std::uint64_t times = 0;
};

template <class V>
void describe(V& v, const RayStageSum& r) {
  v.field("stage", r.stage, "", "a stage, as in spans; the longest comes first");
  v.field("length", r.length, "cycles|seconds", "time in it, all spans together");
  v.field("share", r.share, "fraction", "part of latency");
  v.field("times", r.times, "spans", "number of spans");
}

struct RayHit {
  double t = 0;
  std::uint64_t instance = 0, primitive = 0;
};

template <class V>
void describe(V& v, const RayHit& r) {
  v.field("t", r.t, "", "parameter of the ray at the hit");
  v.field("instance", r.instance, "", "instance that it hit");
  v.field("primitive", r.primitive, "", "primitive of the instance's mesh");
}

struct RayTest {
  double at = 0;
  std::uint64_t resource = 0;
  std::optional<std::uint64_t> packet{};
  std::string node;
  std::optional<std::uint64_t> depth{};
  std::uint64_t shapes = 0;
  std::optional<std::uint64_t> hit{};
  std::optional<RayHit> found{};
};

template <class V>
void describe(V& v, const RayTest& r) {
  v.field("at", r.at, "cycles|seconds", "begin of the test");
  v.field("resource", r.resource, "", "resource that tested it, which has its record");
  v.field("packet", r.packet, "", "packet that brought the shapes");
  v.field("node", r.node, "", "node of the tree");
  v.field("depth", r.depth, "", "depth of the node below the root, in strips");
  v.field("shapes", r.shapes, "shapes", "children of the node, or triangles of the leaf");
  v.field("hit", r.hit, "shapes", "children of the node that it hit and that packets of their own will be tested for");
  v.section("found", r.found, "hit that is nearer than those before; absent if none was");
}

/// The life of one ray, as `carousel follow --json` prints it.
struct RayLife {
  std::int64_t schema_version = kDocumentVersion;
  std::string engine, unit;
  RayName ray;
  std::array<double, 3> origin{}, direction{};
  double begin = 0, end = 0, latency = 0;
  bool complete = false;
  std::optional<std::uint64_t> resource{}, slot{};
  std::uint64_t packets = 0, hops = 0;
  std::optional<RayHit> hit{};
  bool occluded = false;
  std::vector<RayStageSum> stages{};
  std::vector<RaySpan> spans{};
  std::vector<RayTest> tests{};
  std::vector<RayName> caused{};
  std::optional<std::string> checksum{};  ///< set where the text is written (report/read/document.h)
};

template <class V>
void describe(V& v, const RayLife& r) {
  v.field("schema_version", r.schema_version, "", "version of these keys");
  v.field("engine", r.engine, "", "native or cycle");
  v.field("unit", r.unit, "", "unit of all times: cycles or seconds");
  v.section("ray", r.ray, "the ray");
  v.field("origin", r.origin, "", "its origin, in world space");
  v.field("direction", r.direction, "", "its direction");
  v.field("begin", r.begin, "cycles|seconds", "time of the run when it was made");
  v.field("end", r.end, "cycles|seconds", "time when its hit had been shaded");
  v.field("latency", r.latency, "cycles|seconds", "time between the two");
  v.field("complete", r.complete, "", "false: the run ended before");
  v.field("resource", r.resource, "", "resource that had its record");
  v.field("slot", r.slot, "", "slot of the ray store there");
  v.field("packets", r.packets, "packets", "packets that it was a member of");
  v.field("hops", r.hops, "links", "links that they crossed with it");
  v.section("hit", r.hit, "closest hit; absent for a miss and for a shadow ray");
  v.field("occluded", r.occluded, "", "a shadow ray met something");
  v.section("stages", r.stages, "where its time went");
  v.section("spans", r.spans, "its time, stretch by stretch, without a gap");
  v.section("tests", r.tests, "its tests, in their order");
  v.section("caused", r.caused, "rays that came of it");
  v.field("checksum", r.checksum, "", kChecksumMeaning);
}

}  // namespace carousel::report
