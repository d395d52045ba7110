#include "app/accuracy/pictures.h"

#include <algorithm>
#include <cmath>

#include "accel/traverse/reference_tracer.h"
#include "app/accuracy/exact_answers.h"
#include "app/run/hit_recorder.h"
#include "app/run/memory_need.h"
#include "shading/tracer/path_tracer.h"

namespace carousel::app {

Picture render(const scene::Scene& scene, const Config& config, const accel::Accel& accel,
               std::vector<report::HitRow>* rows) {
  shading::PathTracer tracer(scene, config, paths_in_flight(config), 1);
  HitRecorder recorder(1);
  if (rows != nullptr) tracer.set_recorder(&recorder);
  accel::run_reference(accel, tracer);
  if (rows != nullptr) *rows = recorder.take();
  return tracer.linear_rgb();
}

Picture render_exact(const scene::Scene& scene, const Config& config, const accel::ExactReference& reference) {
  shading::PathTracer tracer(scene, config, paths_in_flight(config), 1);
  RayBatch rays, next;
  HitBatch hits;
  bool finished = false;
  while (!finished || !rays.empty()) {
    if (rays.empty()) finished = tracer.generate(WorkerId{0}, 4096, rays).finished;
    hits.clear();
    const std::vector<accel::ExactHit> answers = exact_answers(reference, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) hits.push_back({rays[i].ray, answers[i].hit, rays[i].tag});
    next.clear();
    if (!hits.empty()) tracer.shade(WorkerId{0}, hits, next);
    rays.swap(next);
  }
  return tracer.linear_rgb();
}

report::PictureErrors compare(const Picture& picture, const Picture& exact) {
  report::PictureErrors errors;
  errors.pixels = exact.size() / 3;
  double squares = 0;
  for (std::size_t p = 0; p < exact.size(); p += 3) {
    bool differs = false;
    for (std::size_t c = p; c < p + 3; ++c) {
      const double off = std::abs(double(picture[c]) - exact[c]);
      differs |= picture[c] != exact[c];
      squares += off * off;
      errors.worst = std::max(errors.worst, off);
    }
    errors.differ += differs;
  }
  if (!exact.empty()) errors.rmse = std::sqrt(squares / static_cast<double>(exact.size()));
  return errors;
}

double noise(const Picture& picture, const Picture& truth) {
  std::vector<double> squares;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double off = double(std::clamp(picture[i], 0.0f, 1.0f)) - std::clamp(truth[i], 0.0f, 1.0f);
    squares.push_back(off * off);
  }
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 50);
  double sum = 0;
  for (const double square : squares) sum += square;
  return squares.empty() ? 0 : std::sqrt(sum / static_cast<double>(squares.size()));
}

SelfHits count_self_hits(const scene::Scene& scene, std::vector<report::HitRow> rows) {
  std::erase_if(rows, [](const report::HitRow& row) { return row.result.tag.kind == RayKind::kShadow; });
  report::sort_rows(rows);  // the rays of a path one after the other
  const auto is_flat = [&](const Hit& hit) {
    return hit.primitive < scene.meshes[scene.instances[hit.instance].mesh.value].triangle_count();
  };
  SelfHits out;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const report::HitRow &from = rows[i - 1], &to = rows[i];
    if (to.result.tag.kind != RayKind::kBounce || from.pixel != to.pixel || from.sample != to.sample) continue;
    if (from.result.hit.valid() && !is_flat(from.result.hit)) continue;
    ++out.bounces;
    out.self_hits += to.result.hit.valid() && to.result.hit.instance == from.result.hit.instance &&
                     to.result.hit.primitive == from.result.hit.primitive;
  }
  return out;
}

}  // namespace carousel::app
