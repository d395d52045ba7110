#include "ringbus/native/shader_worker.h"

#include <algorithm>

#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

namespace {
// Rays generated, or handed over in order, at once: few enough that they are still in cache when ray control puts them
// into their slots.
constexpr std::int64_t kGenerateBatch = 4096;
constexpr std::size_t kSubmitBatch = kGenerateBatch;
}  // namespace

ShaderWorker::ShaderWorker(WorkerId id, RayControl& control, CompletedQueue& completed, Workload& workload,
                           RayCount& count, std::int64_t slots, std::int64_t workers, RaySort sort,
                           OutstandingRays* ledger)
    : id_(id),
      control_(control),
      completed_(completed),
      workload_(workload),
      count_(count),
      ledger_(ledger),
      slots_(slots),
      workers_(workers) {
  if (sort == RaySort::kCells) sorter_.emplace();
}

bool ShaderWorker::step() {
  const bool placed = control_.place_waiting();
  return shade() || submit_gathered() || generate() || placed;
}

/// Hands the rays over that wait to be sorted.
bool ShaderWorker::submit_gathered() {
  if (gathered_.empty()) return false;
  sorter_->order(gathered_);
  for (std::size_t begin = 0; begin < gathered_.size(); begin += kSubmitBatch) {
    rays_.clear();
    sorter_->copy(gathered_, begin, std::min(begin + kSubmitBatch, gathered_.size()), rays_);
    schedule_point();
    control_.submit(rays_);
  }
  gathered_.clear();
  return true;
}

/// Hands new rays over, or keeps them for others that they are sorted with.
void ShaderWorker::hand_over() {
  if (sorter_)
    gathered_.insert(gathered_.end(), rays_.begin(), rays_.end());
  else if (!rays_.empty())
    control_.submit(rays_);
}

bool ShaderWorker::shade() {
  HitBatch* const batch = completed_.try_pop();
  if (batch == nullptr) return false;
  rays_.clear();
  // Before they are shaded: their paths' numbers may then be in use for new rays of any worker.
  if (ledger_ != nullptr) ledger_->remove(*batch);
  schedule_point();
  workload_.shade(id_, *batch, rays_);
  schedule_point();
  const std::int64_t made = static_cast<std::int64_t>(rays_.size()), shaded = static_cast<std::int64_t>(batch->size());
  // Relaxed: sums for the report and the progress bar.
  count_.emitted.fetch_add(rays_.size(), std::memory_order_relaxed);
  count_.completed.fetch_add(batch->size(), std::memory_order_relaxed);
  schedule_point();
  // One addition for both: the count cannot pass through zero while rays are about to be submitted. Release:
  // pairs with the acquire in done(); a thread that sees zero sees the shading finished.
  count_.outstanding.fetch_add(made - shaded, std::memory_order_release);
  if (ledger_ != nullptr) ledger_->add(rays_);
  schedule_point();
  batch->clear();
  completed_.give_back(batch);
  schedule_point();
  hand_over();
  return true;
}

bool ShaderWorker::generate() {
  // Acquire: pairs with the release below, and is only a hint here.
  if (count_.source_finished.load(std::memory_order_acquire)) return false;
  const std::int64_t room = slots_ - count_.outstanding.load(std::memory_order_relaxed);
  if (sorter_ && 2 * room < slots_) return false;
  // All that fit, so that resources find whole groups waiting when they come round again.
  std::int64_t left = std::min(room, slots_ / workers_ + 1);
  bool any = false;
  while (left > 0) {
    const std::int64_t wanted = std::min(left, kGenerateBatch);
    // Counted before they exist, so that no thread sees the source finished with the last rays not yet counted.
    count_.outstanding.fetch_add(wanted, std::memory_order_relaxed);
    rays_.clear();
    schedule_point();
    const Workload::Generated made = workload_.generate(id_, static_cast<std::size_t>(wanted), rays_);
    schedule_point();
    count_.outstanding.fetch_add(static_cast<std::int64_t>(made.rays) - wanted, std::memory_order_release);
    count_.emitted.fetch_add(made.rays, std::memory_order_relaxed);
    schedule_point();
    // Release: pairs with the acquire in done().
    if (made.finished) count_.source_finished.store(true, std::memory_order_release);
    schedule_point();
    if (ledger_ != nullptr) ledger_->add(rays_);
    schedule_point();
    hand_over();
    any |= made.rays > 0;
    if (made.finished || static_cast<std::int64_t>(made.rays) < wanted) break;
    left -= wanted;
  }
  return any;
}

}  // namespace carousel::ringbus
