// Paths that start at hits which a rasteriser found (shading/raster/first_hits.h).
#include <utility>
#include <vector>

#include "shading/raster/first_hits.h"
#include "shading/tracer/path_tracer-inl.h"

namespace carousel::shading {

namespace {

/// The sample of a path, by its ordinal in the frame.
void append_read(std::uint64_t ordinal, std::vector<DataRead>& reads) {
  const std::uint64_t offset = ordinal * FirstHits::kSampleBytes;
  if (reads.empty() || reads.back().offset + reads.back().bytes != offset) reads.push_back({offset, 0});
  reads.back().bytes += FirstHits::kSampleBytes;
}

}  // namespace

void PathTracer::shade_first(const RayResult& result, Worker& worker, RayBatch& out) {
  std::uint32_t children = 0;
  const Hit& hit = result.hit;
  if (hit.valid()) {
    const TrianglePoint point = triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v);
    const auto material = static_cast<std::size_t>(point.material - scene_.materials.data());
    (this->*surfaces_[material].shade)(result, point, worker, out, children);
  } else {
    shade_miss(result, worker);
  }
  finish_ray(result.tag.path, children, worker);
}

Workload::Generated PathTracer::generate_from_hits(WorkerId worker_id, std::size_t max_rays, RayBatch& out) {
  Worker& worker = workers_[worker_id.value];
  const std::size_t end = out.size() + max_rays;
  while (!worker.held.empty() && out.size() < end) {
    out.push_back(worker.held.back());
    worker.held.pop_back();
    paths_.release();
  }
  std::vector<DataRead> reads;
  std::size_t made = 0;
  const std::size_t before = out.size();
  bool all_begun = false;
  do {
    // A first hit sends two rays at most; an odd one is held back.
    worker.begun.clear();
    worker.states.clear();
    const PathPool::Admission admitted = pool_.admit((end - out.size() + 1) / 2, worker.begun);
    made = admitted.count;
    for (std::size_t i = 0; i < made; ++i) {
      const std::uint32_t index = worker.begun[i];
      const PixelSample at = begin_path(admitted.first + i, index);
      if (!first_hits_->tiles.empty()) append_read(paths_.ordinal(admitted.first + i), reads);
      const PathState& path = pool_.state(index);
      const Ray ray = camera_.ray(at.x, at.y, sampler_.camera(path.pixel, path.sample));
      const RayTag tag{index, RayKind::kCamera, 0, 0, 0};
      if (const Hit* hit = first_hits_->at(path.pixel, path.sample)) {
        shade_first({ray, *hit, tag}, worker, out);
      } else {
        emit(ray, tag, worker, out);
      }
    }
    pool_.release(worker.states);
    while (out.size() > end) {
      worker.held.push_back(out.back());
      out.pop_back();
      paths_.hold();
    }
    // After rays are held: a thread that reads the full count also reads their number.
    all_begun = paths_.begin(made);
    // A path that ends at its first hit has no ray; the engine would wait for one forever.
  } while (made > 0 && out.size() == before && out.size() < end);
  return {out.size() - (end - max_rays), all_begun && paths_.none_held(), std::move(reads)};
}

}  // namespace carousel::shading
