#include "ringbus/cycle/shading/shade_workers.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

namespace {

constexpr std::uint32_t kNoPlace = ~0u;

}  // namespace

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
      cores_(settings.programs ? std::make_unique<ShadeCores>(settings.shading, settings.programs, settings.workers,
                                                              settings.vectors, workload)
                               : nullptr),
      jobs_(settings.workers * settings.vectors) {
  if (settings.shading.sort == ShadingConfig::Sort::kShader)
    sorter_ = std::make_unique<ShadeSorter>(static_cast<std::size_t>(settings.shading.sort_rays_per_cycle));
  for (auto place = static_cast<std::uint32_t>(jobs_.size()); place-- > 0;) idle_.push_back(place);
  for (std::uint32_t r = 0; r < clients.size(); ++r)
    if (clients[r].questions != nullptr) callers_.push_back(r);
}

Cycle ShadeWorkers::next() const {
  Cycle first = ends_.empty() ? kNever : ends_.top().done;
  if (cores_) first = std::min(first, cores_->next());
  for (const std::uint32_t r : callers_) first = std::min(first, clients_[r].questions->next());
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
  for (const std::uint32_t r : callers_)
    while (clients_[r].questions->next() <= now) calls_.push_back({r, clients_[r].questions->take()});
}

bool ShadeWorkers::start(Cycle now) {
  bool any = false;
  if (cores_) order_idle();
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

/// Places of workers that hold few jobs come last, so that they are taken first.
void ShadeWorkers::order_idle() {
  if (idle_.empty() || (queues_.empty() && calls_.empty() && camera_.finished())) return;
  std::vector<std::size_t> taken(jobs_.size() / cores_->vectors());
  for (std::size_t w = 0; w < taken.size(); ++w) taken[w] = cores_->held(w);
  std::sort(idle_.begin(), idle_.end(), std::greater<>());
  std::vector<std::pair<std::size_t, std::uint32_t>> ordered;
  for (std::size_t i = idle_.size(); i-- > 0;) ordered.emplace_back(taken[worker_of(idle_[i])]++, idle_[i]);
  std::sort(ordered.begin(), ordered.end(), std::greater<>());
  for (std::size_t i = 0; i < idle_.size(); ++i) idle_[i] = ordered[i].second;
}

bool ShadeWorkers::start_job(std::uint32_t place, Cycle now) {
  Job& job = jobs_[place];
  job.began = now;
  job.rays = 1;
  if (!calls_.empty()) {
    job.call = std::move(calls_.front());
    calls_.pop_front();
  } else if (queues_.take(worker_of(place), job.vector)) {
    for (const RayResult& ray : job.vector.rays) recorder_.begin_shading(ray, now);
    job.rays = job.vector.rays.size();
  } else if (job.rays = camera_.take(job.made); job.rays == 0) {
    read_first_hits(kNoPlace, now);
    return false;
  } else {
    job.reads = read_first_hits(place, now);
  }
  if (job.reads == 0) begin(place, now);
  set_rays(place, job.rays);
  return true;
}

/// Reads the samples at which the last paths have begun; returns how many reads there are.
std::size_t ShadeWorkers::read_first_hits(std::uint32_t place, Cycle now) {
  const std::vector<DataRead> reads = camera_.take_first_hits();
  for (const DataRead& read : reads)
    memory_->read(ShadeData::kFirstHits, read, {.vector = place, .to = ProgramRead::To::kCameraRays}, now);
  return reads.size();
}

void ShadeWorkers::answer(const ProgramRead& read, Cycle now) {
  if (read.to != ProgramRead::To::kCameraRays) return cores_->answer(read, now);
  if (read.vector == kNoPlace || --jobs_[read.vector].reads > 0) return;
  jobs_[read.vector].began = now;
  begin(read.vector, now);
}

/// The job of this place begins: its end is known, or that of its programs will be.
void ShadeWorkers::begin(std::uint32_t place, Cycle now) {
  Job& job = jobs_[place];
  if (job.call && cores_ && cores_->answers_any_hit()) {
    cores_->begin_any_hit(place, job.call->rays.calls, now);
  } else if (job.call) {
    const Cycle cycles = costs_.any_hit_calls(job.call->rays.calls.size());
    ends_.push({cores_ ? cores_->occupy(place, cycles, now) : now + cycles, place});
  } else if (job.made.empty()) {
    if (cores_)
      cores_->begin(place, job.vector.rays, now);
    else
      ends_.push({now + costs_.begin(job.vector), place});
  } else if (cores_) {
    cores_->begin_camera_rays(place, job.rays, now);
  } else {
    ends_.push({now + costs_.camera_rays(job.rays), place});
  }
}

/// Tells the queues how many rays a worker has in work.
void ShadeWorkers::set_rays(std::uint32_t place, std::size_t rays) {
  jobs_[place].rays = rays;
  if (!cores_) return queues_.set_in_work(place, rays);
  const std::uint32_t worker = worker_of(place);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < cores_->vectors(); ++i) sum += jobs_[worker * cores_->vectors() + i].rays;
  queues_.set_in_work(worker, sum);
}

ShadeWorkers::Job& ShadeWorkers::end_job(JobEnd end) {
  Job& job = jobs_[end.place];
  if (cores_)
    cores_->release(end.place, end.done);
  else
    busy_ += end.done - job.began;
  idle_.push_back(end.place);
  set_rays(end.place, 0);
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
