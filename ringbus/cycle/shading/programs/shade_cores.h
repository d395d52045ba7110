#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/config/fields/shading.h"
#include "core/program/shade_programs.h"
#include "core/statistics/shading_counts.h"
#include "core/types/workload.h"
#include "ringbus/cycle/shading/programs/data_path.h"
#include "ringbus/cycle/shading/programs/shade_core.h"

namespace carousel::ringbus::cycle {

/// The shader workers that run programs. Place p belongs to worker p / vectors; each holds a vector or another job.
class ShadeCores {
 public:
  /// `vectors` of a worker. Keeps a reference to the workload.
  ShadeCores(const ShadingConfig& shading, std::shared_ptr<const ShadePrograms> programs, std::size_t workers,
             std::size_t vectors, const Workload& workload)
      : workload_(workload),
        programs_(std::move(programs)),
        cache_(shading.data_cache),
        pages_(shading.translation),
        vectors_(vectors),
        held_(workers) {
    for (std::uint32_t w = 0; w < workers; ++w)
      cores_.emplace_back(*programs_, shading.instruction_cache, w, vectors_, static_cast<std::size_t>(shading.lanes));
  }

  void read_through(ProgramMemory& memory) {
    memory_ = &memory;
    if (cache_.bytes == 0 && pages_.page_bytes == 0) return;
    for (std::uint32_t w = 0; w < cores_.size(); ++w)
      paths_.push_back(std::make_unique<DataPath>(cache_, pages_, w, memory));
  }
  void answer(const ProgramRead& read, Cycle now) {
    if (read.to == ProgramRead::To::kRegister)
      cores_[read.worker].answer(read, now);
    else
      paths_[read.worker]->take(read, now);
  }

  /// A vector of completed rays begins.
  void begin(std::uint32_t place, const HitBatch& vector, Cycle now) {
    std::vector<ShadeCore::Ray> rays;
    for (const RayResult& ray : vector) rays.push_back({workload_.shader(ray), workload_.shade_facts(ray)});
    begin(place, std::move(rays), now);
  }
  void begin_camera_rays(std::uint32_t place, std::size_t count, Cycle now) {
    begin(place, std::vector<ShadeCore::Ray>(count, ShadeCore::Ray{kCameraKind}), now);
  }
  /// True if any-hit calls run a program.
  bool answers_any_hit() const { return programs_->any_hit; }
  void begin_any_hit(std::uint32_t place, const HitBatch& calls, Cycle now) {
    std::vector<ShadeCore::Ray> rays;
    for (const RayResult& call : calls) rays.push_back({kAnyHitKind, workload_.any_hit_facts(call)});
    begin(place, std::move(rays), now);
  }
  /// Another job, of constant time, which holds up all vectors of its worker. Returns its end.
  Cycle occupy(std::uint32_t place, Cycle cycles, Cycle now) {
    hold(place, now);
    return cores_[place / vectors_].occupy(cycles, now);
  }
  /// What was in this place is over.
  void release(std::uint32_t place, Cycle now) {
    Held& held = held_[place / vectors_];
    if (--held.places == 0) busy_ += now - held.since;
  }
  /// Issues what can be issued now; calls on_end(place) for the vectors that have ended.
  template <class OnEnd>
  void step(Cycle now, OnEnd&& on_end) {
    do {
      step_once(now, on_end);
    } while (std::ranges::any_of(paths_, [now](const auto& path) { return path->next() <= now; }));
  }
  Cycle next() const {
    Cycle first = kNever;
    for (const ShadeCore& core : cores_) first = std::min(first, core.next());
    for (const auto& path : paths_) first = std::min(first, path->next());
    return first;
  }

  std::size_t vectors() const { return vectors_; }
  std::size_t held(std::size_t worker) const { return held_[worker].places; }
  std::size_t working() const {
    return static_cast<std::size_t>(
        std::count_if(held_.begin(), held_.end(), [](const Held& held) { return held.places > 0; }));
  }
  /// Worker-cycles in which no other work could be issued.
  Cycle issuing() const {
    Cycle sum = 0;
    for (const ShadeCore& core : cores_) sum += core.issuing();
    return sum;
  }
  void add_to(ShadingCounts& counts) const {
    for (const ShadeCore& core : cores_) {
      counts.programs += core.counts();
      counts.programs.instruction_misses += core.instruction_misses();
      counts.programs.instruction_bytes += core.instruction_bytes();
      counts.vectors += core.vectors();
    }
    for (const auto& path : paths_) counts.data += path->counts();
    counts.busy = busy_;
  }

 private:
  struct Held {
    std::size_t places = 0;
    Cycle since = 0;
  };

  template <class OnEnd>
  void step_once(Cycle now, OnEnd&& on_end) {
    for (std::size_t w = 0; w < cores_.size(); ++w) {
      ended_.clear();
      DataPath* const path = paths_.empty() ? nullptr : paths_[w].get();
      if (path != nullptr) path->step(now, [&](const ProgramRead& read) { cores_[w].answer(read, now); });
      cores_[w].step(now, path != nullptr ? path : memory_, ended_);
      for (const std::size_t at : ended_) on_end(static_cast<std::uint32_t>(w * vectors_ + at));
    }
  }
  void begin(std::uint32_t place, std::vector<ShadeCore::Ray>&& rays, Cycle now) {
    hold(place, now);
    cores_[place / vectors_].begin(place % vectors_, std::move(rays), now);
  }
  void hold(std::uint32_t place, Cycle now) {
    Held& held = held_[place / vectors_];
    if (held.places++ == 0) held.since = now;
  }

  const Workload& workload_;
  std::shared_ptr<const ShadePrograms> programs_;
  DataCacheConfig cache_;
  TranslationConfig pages_;
  std::size_t vectors_;
  std::vector<ShadeCore> cores_;
  std::vector<std::unique_ptr<DataPath>> paths_;  // by worker; none: reads go to memory
  std::vector<Held> held_;                        // by worker
  ProgramMemory* memory_ = nullptr;
  std::vector<std::size_t> ended_;  // scratch
  Cycle busy_ = 0;                  // worker-cycles in which a worker held anything, of times that are over
};

}  // namespace carousel::ringbus::cycle
