#pragma once

#include "report/sections/ray_queue.h"
#include "report/sections/time_series.h"
#include "report/sections/visitor.h"

namespace carousel::report {

struct Machine {
  std::string cpu, system;
  std::uint64_t cores = 0, memory_bytes = 0;
};

template <class V>
void describe(V& v, const Machine& r) {
  v.field("cpu", r.cpu, "", "processor");
  v.field("system", r.system, "", "operating system");
  v.field("cores", r.cores, "cores", "hardware threads");
  v.field("memory_bytes", r.memory_bytes, "bytes", "memory of the machine");
}

/// Occupancy of a link's queue during one part of the run.
struct LinkOccupancy {
  double seconds = 0, mean = 0;
  std::uint64_t most = 0;
};

template <class V>
void describe(V& v, const LinkOccupancy& r) {
  v.field("seconds", r.seconds, "s", "end of this part, measured from the start of the run");
  v.field("mean", r.mean, "packets", "mean of the packets waiting, sampled at every eighth send");
  v.field("most", r.most, "packets", "most packets waiting, sampled at every eighth send");
}

/// The occupancy of one link, part by part over the whole run.
struct HostLink {
  std::uint64_t from = 0, to = 0;
  std::vector<LinkOccupancy> occupancy;
};

template <class V>
void describe(V& v, const HostLink& r) {
  v.field("from", r.from, "", "resource that sends");
  v.field("to", r.to, "", "resource that receives");
  v.section("occupancy", r.occupancy, "occupancy over time, in parts of equal numbers of samples");
}

struct Host {
  std::uint64_t threads = 0;
  double wall_seconds = 0, rays_per_second = 0, scene_seconds = 0, build_seconds = 0;
  std::uint64_t accel_bytes = 0, peak_memory_bytes = 0;
  std::string simd;
  Machine machine;
  std::optional<double> plane_seconds{}, raster_seconds{}, recovery_seconds{}, audit_seconds{}, draw_seconds{};
  std::optional<std::vector<HostLink>> links{};
  std::optional<RayQueues> ray_queues{};
  std::optional<TimeSeries> time_series{};
};

template <class V>
void describe(V& v, const Host& r) {
  v.field("threads", r.threads, "threads", "worker threads");
  v.field("wall_seconds", r.wall_seconds, "s",
          "time of the simulation, with verification, without loading and building");
  v.field("rays_per_second", r.rays_per_second, "rays/s", "completed rays over wall_seconds");
  v.field("scene_seconds", r.scene_seconds, "s", "time to load or generate the scene");
  v.field("build_seconds", r.build_seconds, "s", "time to build the acceleration structure, without cull planes");
  v.field("plane_seconds", r.plane_seconds, "s", "time to find the cull planes");
  v.field("raster_seconds", r.raster_seconds, "s", "time to rasterise the first hits of camera rays");
  v.field("recovery_seconds", r.recovery_seconds, "s",
          "time from the last sign of life of a resource that stopped until its rays were restarted");
  v.field("draw_seconds", r.draw_seconds, "s",
          "time to draw the sample of the frame, most of it to trace a part of the frame depth-first");
  v.field("audit_seconds", r.audit_seconds, "s", "time to simulate the whole frame, with --audit");
  v.field("accel_bytes", r.accel_bytes, "bytes", "size of the acceleration structure");
  v.field("peak_memory_bytes", r.peak_memory_bytes, "bytes", "most resident memory of the process");
  v.field("simd", r.simd, "", "instruction set of the intersection kernels; lists of rays (engine.lanes) need AVX3");
  v.section("links", r.links, "queues of the links over the time of the host, link by link as in links (native)");
  v.section("ray_queues", r.ray_queues, "queues between resources and shader workers (native)");
  v.section("time_series", r.time_series,
            "quantities of the machine's parts over the time of the host, looked at 100 times a second (native)");
  v.section("machine", r.machine, "machine that ran the simulation");
}

}  // namespace carousel::report
