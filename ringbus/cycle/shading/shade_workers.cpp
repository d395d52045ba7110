#include "ringbus/cycle/shading/shade_workers.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

ShadeWorkers::ShadeWorkers(const ShadingSettings& settings, const std::vector<SidePorts>& clients, Workload& workload,
                           CameraRays& camera, ShadingRecorder& recorder)
    : clients_(clients),
      workload_(workload),
      camera_(camera),
      recorder_(recorder),
      costs_(settings.shading, workload),
      by_shader_(settings.shading.lanes > 1),
      queues_(settings.shading, settings.workers, settings.seed),
      answer_wires_(clients.size(), SideWire(settings.link, control_latency(settings.link))),
      jobs_(settings.workers) {
  if (settings.shading.sort == ShadingConfig::Sort::kShader)
    sorter_ = std::make_unique<ShadeSorter>(static_cast<std::size_t>(settings.shading.sort_rays_per_cycle));
  for (std::uint32_t w = static_cast<std::uint32_t>(settings.workers); w-- > 0;) idle_.push_back(w);
}

Cycle ShadeWorkers::next() const {
  Cycle first = ends_.empty() ? kNever : ends_.top().done;
  for (std::uint32_t r = 0; r < clients_.size() && clients_[r].questions != nullptr; ++r)
    first = std::min(first, clients_[r].questions->next());
  return sorter_ ? std::min(first, sorter_->next()) : first;
}

void ShadeWorkers::add(const RayResult& ray, Cycle now) {
  if (sorter_) [[unlikely]]
    return sorter_->push(ray, now);
  queues_.push(ray, by_shader_ ? workload_.shader(ray) : 0);
}

void ShadeWorkers::take_arrivals(Cycle now) {
  if (sorter_) [[unlikely]]
    while (sorter_->next() <= now) {
      const RayResult ray = sorter_->take();
      queues_.push(ray, workload_.shader(ray));
    }
  for (std::uint32_t r = 0; r < clients_.size() && clients_[r].questions != nullptr; ++r)
    while (clients_[r].questions->next() <= now) calls_.push_back({r, clients_[r].questions->take()});
}

bool ShadeWorkers::start(Cycle now) {
  bool any = false;
  // The worker that fell idle last comes first.
  for (std::size_t i = idle_.size(); i-- > 0;) {
    if (!start_job(idle_[i], now)) {
      if (queues_.empty()) break;  // there is nothing for the others either
      continue;
    }
    idle_.erase(idle_.begin() + static_cast<std::ptrdiff_t>(i));
    any = true;
  }
  return any;
}

bool ShadeWorkers::start_job(std::uint32_t worker, Cycle now) {
  Job& job = jobs_[worker];
  job.began = now;
  Cycle done = now;
  std::size_t rays = 1;
  if (!calls_.empty()) {
    job.call = std::move(calls_.front());
    calls_.pop_front();
    done += costs_.any_hit_calls(job.call->rays.times);
  } else if (queues_.take(worker, job.vector)) {
    for (const RayResult& ray : job.vector.rays) recorder_.begin_shading(ray, now);
    rays = job.vector.rays.size();
    done += costs_.begin(job.vector);
  } else if (rays = camera_.take(job.made); rays > 0) {
    done += costs_.camera_rays(rays);
  } else {
    return false;
  }
  queues_.set_in_work(worker, rays);
  ends_.push({done, worker});
  return true;
}

ShadeWorkers::Job& ShadeWorkers::end_job(JobEnd end) {
  Job& job = jobs_[end.worker];
  busy_ += end.done - job.began;
  idle_.push_back(end.worker);
  queues_.set_in_work(end.worker, 0);
  return job;
}

void ShadeWorkers::answer(Job& job, Cycle now) {
  AnyHitAnswer answer{std::move(job.call->rays.slots)};
  const Cycle arrival = answer_wires_[job.call->from].send(answer.bytes(), now);
  clients_[job.call->from].answers->send(arrival, std::move(answer));
  job.call.reset();
}

std::optional<std::pair<RayResult, Cycle>> ShadeWorkers::take_for_helper(Cycle now) {
  const std::optional<RayResult> ray = queues_.take_any();
  if (!ray) return std::nullopt;
  recorder_.begin_shading(*ray, now);
  return std::pair{*ray, costs_.begin(*ray)};
}

}  // namespace carousel::ringbus::cycle
