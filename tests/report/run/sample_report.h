#pragma once

#include "report/run/report.h"

namespace carousel::report {

/// A report with every optional part present and no two counts alike.
inline Report sample_report() {
  Report r;
  r.carousel = {"1.2.3", "abc", "GNU 12", "Release", true};
  r.config = {{"image", {{"width", 64}, {"height", 32}, {"samples", 4}}},
              {"topology", {{"resources", 2}, {"shape", "ring"}}}};
  r.scene = {"cornell", 1234567, 1300000, 3, 5, 7, 0, 0, 0, 1, 1, {{-1, -2, -3}, {1, 2, 3}}, {}};
  r.engine.kind = "native";
  r.engine.reason = "threads";
  r.rays = {1000, 990, 10, 0, 0, {500, 300, 200}};
  r.raster = {9, 8, 7, 6, 5, 4, 3};
  r.throughput = {0.5, 2.5, 17.25};
  r.tests.emplace().rays = 1000;
  r.tests->counts.box = 8500;
  r.tests->counts.triangle = 2250;
  r.tests->counts.transforms = 1000;
  r.cull_planes = {640, 10240, 42.5};
  r.cull_planes->counts.below[3] = {
      .children = 700, .plane_tests = 1500, .boxes = 30, .nodes = 80, .leaves = 180, .triangles = 605};
  r.cull_planes->counts.above[0] = {.children = 90, .plane_tests = 100, .nodes = 5, .instances = 35, .transforms = 35};
  r.packets.emplace().counts = {.packets_issued = 500,
                                .packets_retired = 499,
                                .visits = 80,
                                .bubbles = 10,
                                .hops = 1200,
                                .local_rays = 4000,
                                .packet_rays = 15250,
                                .seen_rays = 16000};
  r.collections = {{77, 13, 4096, 0}, 0.75};
  Resource a, b;
  a.resource = 0;
  a.counts.rays_completed = 400;
  a.stalls.emplace().link = 3;
  b.resource = 1;
  b.counts.rays_completed = 590;
  b.stalls.emplace().link = 4;
  r.resources = {a, b};
  r.links = {{0, 1, 16, 600, 1.5, 9, 7}, {1, 0, 16, 600, 2.5, 11, 0}};
  r.traffic = {1000,       1000,  4, 100, 5000, 900, 0.1, 0.09, 3.5, 16, {17.5, 16, 20, 31, 47},
               {0.3, 0.6}, 12000, 0, 0,   0,    {},  {}};
  r.shading.workers = 2;
  r.shading.shaded = 990;
  r.shading.effects = {{"shadow_rays", true, true, 1, "one light", {}}};
  r.verify = {990, 1, "pixel 3"};
  r.digest = {"0123", "4567"};
  r.host = {4, 2.0, 495, 0.01, 0.2, 1 << 20, 64 << 20, "avx2", {"cpu", "linux", 4, 1ull << 34}};
  r.host.plane_seconds = 0.125;
  r.host.raster_seconds = 0.25;
  return r;
}

}  // namespace carousel::report
