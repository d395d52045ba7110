#include "ringbus/cycle/shading/shading_agent.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

ShadingAgent::ShadingAgent(Machine& machine, const ShadingSettings& settings, Workload& workload,
                           const Observation& observed, std::vector<SidePorts> clients)
    : machine_(machine),
      fault_(settings.fault),
      workload_(workload),
      clients_(std::move(clients)),
      trace_(static_cast<std::uint32_t>(machine.topology.resources()), observed.steps),
      shade_cycles_(static_cast<Cycle>(settings.shading.cycles_per_shade)),
      lookup_cycles_(static_cast<Cycle>(settings.shading.cycles_per_lookup)),
      products_per_cycle_(static_cast<std::uint64_t>(settings.shading.products_per_cycle)),
      any_hit_cycles_(static_cast<Cycle>(settings.shading.cycles_per_any_hit)),
      load_cycles_(ceil_div(sizeof(RayRecord), static_cast<std::uint64_t>(settings.link.bytes_per_cycle))),
      latency_(control_latency(settings.link)),
      slots_(settings.slots),
      group_(settings.packet_rays),
      gather_(group_),
      bundled_(settings.bundles.size > 0),
      builder_rate_(static_cast<Cycle>(settings.bundles.builder.rays_per_cycle)),
      lanes_(static_cast<std::size_t>(settings.shading.lanes)),
      queues_(settings.shading, settings.workers, settings.seed),
      helpers_(clients_, settings.link),
      jobs_(settings.workers),
      made_(settings.workers),
      rays_travel_(machine.control.rays_travel()),
      load_free_(clients_.size()),
      id_wires_(clients_.size(), SideWire(settings.link, latency_)),
      answer_wires_(clients_.size(), SideWire(settings.link, latency_)),
      samples_(observed.samples, kFirstHeldCounter + clients_.size()),
      held_(clients_.size()) {
  if (settings.shading.sort == ShadingConfig::Sort::kShader)
    sorter_ = std::make_unique<ShadeSorter>(static_cast<std::size_t>(settings.shading.sort_rays_per_cycle));
  for (const auto& store : machine.stores) placed_at_.emplace_back(store->slots());
  if (rays_travel_)
    free_slots_.assign(settings.addressed ? clients_.size() : 1,
                       settings.addressed ? slots_ / clients_.size() : slots_);
  if (fault_.kind == FaultsConfig::Resource::Kind::kStop) ledger_ = std::make_unique<OutstandingRays>();
  for (std::uint32_t w = static_cast<std::uint32_t>(settings.workers); w-- > 0;) idle_.push_back(w);
  const std::size_t open = static_cast<std::size_t>(settings.bundles.size * settings.bundles.builder.open);
  if (bundled_) gather_ = std::max(group_, std::min(slots_ / 4, open));
}

Cycle ShadingAgent::next() const {
  Cycle first = next_but_completed();
  for (const SidePorts& client : clients_)
    if (!done()) first = std::min(first, client.completed->next());
  return first;
}

Cycle ShadingAgent::next_but_completed() const {
  if (!started_) return 0;
  Cycle first = ends_.empty() ? kNever : ends_.top().done;
  // When all is done nothing of importance comes, and a resource that stops then is not waited for.
  if (!done()) first = std::min(first, give_up_at_);
  for (std::uint32_t r = 0; r < clients_.size() && clients_[r].questions != nullptr; ++r)
    first = std::min(first, clients_[r].questions->next());
  if (data_) first = std::min(first, data_->next());
  if (sorter_) first = std::min(first, sorter_->next());
  return std::min(first, helpers_.next());
}

void ShadingAgent::run(Cycle end) {
  window_end_ = end;
  if (next_completed_ < end) {
    next_completed_ = kNever;
    for (std::uint32_t r = 0; r < clients_.size(); ++r) look_for(r);
  }
  const auto next_known = [&] {
    const Cycle completed = due_.empty() ? next_completed_ : due_.top().at;
    return std::min(next_but_completed(), done() ? kNever : completed);
  };
  while ((next_ = next_known()) < end) step(next_);
}

/// Notes when the next completed rays of a resource arrive. A run asks all resources at most once, as most have sent
/// nothing.
void ShadingAgent::look_for(std::uint32_t client) {
  const Cycle at = clients_[client].completed->next();
  if (at < window_end_)
    due_.push({at, client});
  else
    next_completed_ = std::min(next_completed_, at);
}

void ShadingAgent::step(Cycle now) {
  sample(now);
  started_ = true;
  now_ = now;
  take_completed(now);
  if (data_) [[unlikely]]
    take_ray_data(now);
  if (sorter_) [[unlikely]]
    while (sorter_->next() <= now) {
      const RayResult ray = sorter_->take();
      queues_.push(ray, workload_.shader(ray));
    }
  if (give_up_at_ <= now) give_up(now);
  take_questions(now);
  // Shading that takes no time ends in the cycle in which it starts.
  while (finish_jobs(now) || start_jobs(now)) {
  }
  place(now);
}

void ShadingAgent::take_completed(Cycle now) {
  for (; !due_.empty() && due_.top().at <= now;) {
    const std::uint32_t r = due_.top().from;
    due_.pop();
    while (clients_[r].completed->next() <= now) {
      const CompletedRays done = clients_[r].completed->take();
      if (done.note != CompletedRays::Note::kDone) {
        on_note(r, done.note, now);
        continue;
      }
      if (rays_travel_) {
        free_slots_[free_slots_.size() == 1 ? 0 : r] += done.slots.size();
        for (const Cycle placed : done.placed) residence_.add(now - placed);
      } else {
        machine_.control.free(ResourceId(r), done.slots);
        for (const std::uint32_t slot : done.slots)
          if (slot < placed_at_[r].size()) residence_.add(now - placed_at_[r][slot]);
        held_[r].change(now, -static_cast<std::int64_t>(done.slots.size()));
      }
      if (ledger_) ledger_->remove(done.rays);
      if (recording_.ray != nullptr) [[unlikely]]
        note_taken(done.rays, now);
      if (data_) [[unlikely]]
        data_->completed(ResourceId(r), done.slots, now);
      for (const RayResult& ray : done.rays)
        if (!data_ || !data_->fetch_state(ray, now)) to_be_shaded(ray, now);
    }
    look_for(r);
  }
}

void ShadingAgent::to_be_shaded(const RayResult& ray, Cycle now) {
  if (sorter_) [[unlikely]]
    return sorter_->push(ray, now);
  queues_.push(ray, lanes_ > 1 ? workload_.shader(ray) : 0);
}

void ShadingAgent::take_questions(Cycle now) {
  for (std::uint32_t r = 0; r < clients_.size() && clients_[r].questions != nullptr; ++r)
    while (clients_[r].questions->next() <= now) questions_.push_back({r, clients_[r].questions->take()});
}

bool ShadingAgent::finish_jobs(Cycle now) {
  shaded_.clear();
  helpers_.take_notes(now, shaded_);
  bool any = false;
  for (; !ends_.empty() && ends_.top().done <= now; ends_.pop()) {
    const auto [done, worker] = ends_.top();
    Job& job = jobs_[worker];
    any = true;
    busy_ += done - job.began;
    idle_.push_back(worker);
    queues_.set_in_work(worker, 0);
    if (job.question) {
      AnyHitAnswer answer{std::move(job.question->rays.slots)};
      const Cycle arrival = answer_wires_[job.question->from].send(answer.bytes(), now);
      clients_[job.question->from].answers->send(arrival, std::move(answer));
      job.question.reset();
      continue;
    }
    if (job.made == 0) {
      shaded_.insert(shaded_.end(), job.vector.rays.begin(), job.vector.rays.end());
      continue;
    }
    making_ -= job.made;
    outstanding_ += job.made;
    emitted_ += job.made;
    if (recording_.ray != nullptr) [[unlikely]]
      note_made(made_[worker], job.began, now);
    if (data_) [[unlikely]]
      data_->made(made_[worker], now);
    gathered_.insert(gathered_.end(), made_[worker].begin(), made_[worker].end());
    made_[worker].clear();
  }
  if (shaded_.empty()) return any;
  const std::size_t before = gathered_.size();
  if (recording_.ray != nullptr) [[unlikely]]
    note_shaded(now);
  if (data_) [[unlikely]]
    data_->will_shade(shaded_);
  workload_.shade(WorkerId(0), shaded_, gathered_);
  if (data_) [[unlikely]] {
    data_->made(std::span(gathered_).subspan(before), now);
    data_->shaded(shaded_, now);
  }
  if (recording_.ray != nullptr) [[unlikely]]
    note_made(std::span(gathered_).subspan(before), now, now);
  trace_.note(now, StepKind::kShade, 0, shaded_.size());
  outstanding_ += gathered_.size() - before;
  emitted_ += gathered_.size() - before;
  outstanding_ -= shaded_.size();
  completed_ += shaded_.size();
  source_dry_ = false;
  return true;
}

std::size_t ShadingAgent::room() const {
  const std::uint64_t taken = outstanding_ + making_;
  return taken >= slots_ ? 0 : std::min<std::size_t>(group_, slots_ - taken);
}

bool ShadingAgent::start_jobs(Cycle now) {
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
  while (helpers_.any()) {
    const std::optional<RayResult> ray = queues_.take_any();
    if (!ray) break;
    if (recording_.ray != nullptr && recording_.ray->ray->is(ray->tag)) [[unlikely]]
      shade_began_ = now;
    helpers_.give(*ray, cycles_for(*ray), now);
    any = true;
  }
  return any;
}

/// Each shader takes as long as the longest of its rays.
Cycle ShadingAgent::cycles_for(const ShadeVector& vector) {
  Cycle sum = 0;
  for (std::size_t i = 0; i < vector.rays.size(); ++i) {
    // The shader has had its turn with an earlier ray.
    const auto first = vector.shaders.begin(), here = first + static_cast<std::ptrdiff_t>(i);
    if (std::find(first, here, *here) != here) continue;
    Cycle longest = 0;
    for (std::size_t j = i; j < vector.rays.size(); ++j)
      if (vector.shaders[j] == *here) longest = std::max(longest, cycles_for(vector.rays[j]));
    sum += longest;
    ++vectors_.runs;
  }
  ++vectors_.vectors;
  vectors_.rays += vector.rays.size();
  return sum;
}

Cycle ShadingAgent::cycles_for(const RayResult& ray) {
  const ShadeWork work = workload_.extra_work(ray);
  products_ += work.products;
  lookups_ += work.lookups;
  const Cycle products = products_per_cycle_ == 0 ? 0 : ceil_div(work.products, products_per_cycle_);
  return shade_cycles_ + lookup_cycles_ * work.lookups + products;
}

std::size_t ShadingAgent::take_camera_rays(std::uint32_t worker) {
  if (source_finished_ || source_dry_ || room() == 0) return 0;
  const Workload::Generated answer = workload_.generate(WorkerId(0), room(), made_[worker]);
  source_finished_ = answer.finished;
  source_dry_ = answer.rays == 0;
  making_ += answer.rays;
  return answer.rays;
}

bool ShadingAgent::start_job(std::uint32_t worker, Cycle now) {
  Job& job = jobs_[worker];
  job.began = now;
  job.made = 0;
  Cycle done = now;
  std::size_t rays = 1;
  if (!questions_.empty()) {
    job.question = std::move(questions_.front());
    questions_.pop_front();
    done += any_hit_cycles_ * ceil_div(job.question->rays.times, lanes_);
  } else if (queues_.take(worker, job.vector)) {
    if (recording_.ray != nullptr) [[unlikely]]
      for (const RayResult& ray : job.vector.rays)
        if (recording_.ray->ray->is(ray.tag)) shade_began_ = now;
    rays = job.vector.rays.size();
    done += cycles_for(job.vector);
  } else if (job.made = take_camera_rays(worker); job.made > 0) {
    rays = job.made;
    done += shade_cycles_ * ceil_div(job.made, lanes_);
  } else {
    return false;
  }
  queues_.set_in_work(worker, rays);
  ends_.push({done, worker});
  return true;
}

void ShadingAgent::place(Cycle now) {
  if (draining_ > 0) return;
  const bool full = gathered_.size() >= gather_, last = to_shade() == 0 && ends_.empty() && helpers_.out() == 0;
  bool placed = machine_.control.place_waiting();
  if (full || (last && !gathered_.empty())) {
    if (bundled_) builder_free_ = std::max(builder_free_, now) + ceil_div(gathered_.size(), builder_rate_);
    machine_.control.submit(gathered_);
    if (ledger_) ledger_->add(gathered_);
    gathered_.clear();
    placed = true;
  }
  if (rays_travel_) {
    gather_travellers();
    send_travellers(now);
  } else if (placed) {
    send_groups(now);
  }
}

std::string ShadingAgent::describe() const {
  if (done()) return "";
  return fmt::format("ray control and shading: {} rays outstanding, {} to be shaded, {} free slots, {}", outstanding_,
                     to_shade(), machine_.control.free_slots(), source_finished_ ? "no more to come" : "more to come");
}

}  // namespace carousel::ringbus::cycle
