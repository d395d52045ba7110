#include "ringbus/cycle/shading/shading_pool.h"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

ShadingPool::ShadingPool(const Shared& shared, RayControl& control, const ShadingSettings& settings,
                         std::size_t samples, std::vector<SidePorts> clients)
    : control_(control),
      workload_(shared.workload),
      trace_(shared.trace),
      clients_(std::move(clients)),
      recorder_(shared.machine),
      open_(settings.slots, settings.packet_rays),
      camera_(shared.workload, open_, shared.camera),
      arrivals_(clients_),
      workers_(settings, clients_, shared.workload, camera_, recorder_),
      helpers_(clients_, settings.link),
      placement_(shared.machine, control, settings, clients_, recorder_, shared.trace),
      loss_(settings.fault, settings.link),
      samples_(samples, clients_.size()) {}

void ShadingPool::keep_in_memory(std::unique_ptr<RayData> data) {
  data_ = std::move(data);
  placement_.keep_in_memory(*data_);
  workers_.read_through(*data_);
}

Cycle ShadingPool::next_but_completed(bool done) const {
  Cycle first = std::min(workers_.next(), helpers_.next());
  // When all is done nothing of importance comes, and a resource that stops then is not waited for.
  if (!done) first = std::min(first, loss_.give_up_at());
  return data_ ? std::min(first, data_->next()) : first;
}

void ShadingPool::arrive(Cycle now) {
  samples_.take(now, levels());
  take_completed(now);
  if (data_) [[unlikely]]
    take_ray_data(now);
  workers_.take_arrivals(now);
  if (loss_.give_up_at() <= now) give_up(now);
}

bool ShadingPool::work(Cycle now) {
  bool any = false;
  // Shading that takes no time ends in the cycle in which it starts.
  while (finish_jobs(now) || start_jobs(now)) any = true;
  return any;
}

ShadingLevels ShadingPool::levels() const {
  return {open_.completed(), workers_.waiting(), workers_.working(), placement_.slots().held()};
}

void ShadingPool::take_completed(Cycle now) {
  arrivals_.take(now, [&](std::uint32_t resource, const CompletedRays& done) {
    if (done.note != CompletedRays::Note::kDone) return on_note(resource, done.note, now);
    placement_.free(resource, done, now);
    loss_.came_back(done.rays);
    recorder_.taken(ResourceId(resource), done.rays, done.slots, now);
    if (data_) [[unlikely]]
      data_->completed(ResourceId(resource), done.slots, now);
    for (const RayResult& ray : done.rays)
      if (!data_ || !data_->fetch_for_shading(ray, now)) workers_.add(ray, now);
  });
}

void ShadingPool::take_ray_data(Cycle now) {
  data_->take(now, arrived_);
  for (const RayResult& ray : arrived_.rays) workers_.add(ray, now);
  for (const ProgramRead& read : arrived_.reads) workers_.answer(read, now);
  for (RayData::Group& group : arrived_.groups) placement_.send_group(group.issuer, std::move(group.rays), now);
}

bool ShadingPool::finish_jobs(Cycle now) {
  shaded_.clear();
  helpers_.take_notes(now, shaded_);
  const bool any = workers_.finish(now, shaded_, [&](const RayBatch& made, Cycle began) {
    open_.made(made.size());
    recorder_.made(made, began, now);
    if (data_) [[unlikely]]
      data_->made(made, now);
    placement_.gathered().insert(placement_.gathered().end(), made.begin(), made.end());
  });
  if (shaded_.empty()) return any;
  shade(now);
  return true;
}

/// The workload shades the rays whose time is over, and makes those that they cause.
void ShadingPool::shade(Cycle now) {
  RayBatch& gathered = placement_.gathered();
  const std::size_t before = gathered.size();
  recorder_.shaded(shaded_, now);
  if (data_) [[unlikely]]
    data_->will_shade(shaded_);
  workload_.shade(WorkerId(0), shaded_, gathered);
  const auto caused = std::span(gathered).subspan(before);
  if (data_) [[unlikely]] {
    data_->made(caused, now);
    data_->shaded(shaded_, now);
  }
  recorder_.made(caused, now, now);
  trace_.note(now, StepKind::kShade, 0, shaded_.size());
  open_.caused(caused.size());
  open_.shaded(shaded_.size());
  camera_.ask_again();
}

bool ShadingPool::start_jobs(Cycle now) {
  bool any = workers_.start(now);
  while (helpers_.any()) {
    const auto ray = workers_.take_for_helper(now);
    if (!ray) break;
    helpers_.give(ray->first, ray->second, now);
    any = true;
  }
  return any;
}

void ShadingPool::place(Cycle now) {
  if (loss_.draining()) return;
  const bool last = workers_.waiting() == 0 && workers_.working() == 0 && helpers_.out() == 0;
  placement_.place(now, last, [&](const RayBatch& rays) { loss_.submitted(rays); });
}

void ShadingPool::on_note(std::uint32_t resource, CompletedRays::Note note, Cycle now) {
  if (note == CompletedRays::Note::kLastBeat)
    loss_.on_last_beat(resource, now);
  else if (loss_.drained_last())
    restart(now);
}

void ShadingPool::give_up(Cycle now) {
  const std::uint32_t stopped = loss_.give_up(clients_.size(), open_.completed(), now);
  if (const std::optional<RayResult> ray = helpers_.exclude(clients_[stopped].jobs)) workers_.add(*ray, now);
  placement_.order_all(NewRays::Order::kDiscard, now);
}

/// Begins again, when no packet is under way and no resource holds an ID.
void ShadingPool::restart(Cycle now) {
  control_.discard();
  placement_.slots().clear(now);
  open_.remove_slots(control_.exclude(ResourceId(loss_.stopped())));
  placement_.order_all(NewRays::Order::kResume, now);
  if (const RayBatch rays = loss_.restart(now); !rays.empty()) placement_.place_again(rays, now);
}

std::string ShadingPool::describe() const {
  return fmt::format("ray control and shading: {} rays outstanding, {} to be shaded, {} free slots, {}",
                     open_.outstanding(), workers_.waiting(), control_.free_slots(),
                     camera_.finished() ? "no more to come" : "more to come");
}

}  // namespace carousel::ringbus::cycle
