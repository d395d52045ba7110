#include "accel/traverse/reference_tracer.h"

#include <array>

#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"

namespace carousel::accel {

namespace {

/// `trace` is one of the kernels that trace whatever is below a node.
void trace_batch(decltype(trace_subtree)& trace, const Accel& accel, const RayBatch& rays, HitBatch& out,
                 IntersectionCounts& counts) {
  constexpr std::size_t kChunk = 64;  // records that stay in the first-level cache
  std::array<RayRecord, kChunk> records;
  for (std::size_t begin = 0; begin < rays.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, rays.size() - begin);
    for (std::size_t i = 0; i < count; ++i) start_record(rays[begin + i], records[i]);
    trace(accel, accel.root_key(), {records.data(), nullptr, count}, counts);
    for (std::size_t i = 0; i < count; ++i) finish_record(records[i], out);
  }
}

}  // namespace

void trace_depth_first(const Accel& accel, const RayBatch& rays, HitBatch& out, IntersectionCounts& counts) {
  trace_batch(trace_subtree, accel, rays, out, counts);
}

void trace_depth_first_interleaved(const Accel& accel, const RayBatch& rays, HitBatch& out,
                                   IntersectionCounts& counts) {
  trace_batch(trace_interleaved, accel, rays, out, counts);
}

std::vector<ReferenceRun> run_reference_by_piece(const Accel& accel, Workload& workload, std::size_t pieces,
                                                 const std::function<std::size_t(const RayTag&)>& piece_of,
                                                 std::size_t batch) {
  std::vector<ReferenceRun> runs(pieces);
  RayBatch rays, together, next;
  HitBatch hits;
  bool finished = false;
  while (!finished || !rays.empty()) {
    if (rays.empty()) finished = workload.generate(WorkerId{0}, batch, rays).finished;
    hits.clear();
    // Rays of a piece mostly follow one another, and so do those that they cause.
    for (std::size_t begin = 0; begin < rays.size(); begin += together.size()) {
      const std::size_t piece = piece_of(rays[begin].tag);
      together.clear();
      for (std::size_t i = begin; i < rays.size() && piece_of(rays[i].tag) == piece; ++i) together.push_back(rays[i]);
      trace_depth_first_interleaved(accel, together, hits, runs[piece].tests);
      runs[piece].rays += together.size();
    }
    next.clear();
    if (!hits.empty()) workload.shade(WorkerId{0}, hits, next);
    rays.swap(next);
  }
  return runs;
}

ReferenceRun run_reference(const Accel& accel, Workload& workload, std::size_t batch) {
  ReferenceRun run;
  RayBatch rays, next;
  HitBatch hits;
  bool finished = false;
  while (!finished || !rays.empty()) {
    if (rays.empty()) finished = workload.generate(WorkerId{0}, batch, rays).finished;
    hits.clear();
    trace_depth_first(accel, rays, hits, run.tests);
    run.rays += rays.size();
    next.clear();
    if (!hits.empty()) workload.shade(WorkerId{0}, hits, next);
    rays.swap(next);
  }
  return run;
}

}  // namespace carousel::accel
