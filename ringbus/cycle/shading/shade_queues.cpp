#include "ringbus/cycle/shading/shade_queues.h"

#include <algorithm>

#include "core/numeric/rng.h"

namespace carousel::ringbus::cycle {

using Distribute = ShadingConfig::Distribute;

ShadeQueues::ShadeQueues(const ShadingConfig& shading, std::size_t workers, std::uint64_t seed)
    : distribute_(shading.distribute),
      sorted_(shading.sort == ShadingConfig::Sort::kShader),
      lanes_(static_cast<std::size_t>(shading.lanes)),
      seed_(seed),
      queues_(distribute_ == Distribute::kFifoFill ? 1 : workers, Queue{std::vector<Fifo<Waiting>>(1)}),
      in_work_(workers) {}

std::size_t ShadeQueues::queue_for(const RayResult& ray) {
  switch (distribute_) {
    case Distribute::kFifoFill:
      return 0;
    case Distribute::kRoundRobin:
      return turn_++ % queues_.size();
    case Distribute::kRandom: {
      const std::uint32_t which =
          std::uint32_t{ray.tag.bounce} << 16 | static_cast<std::uint32_t>(ray.tag.kind) << 8 | ray.tag.index;
      const PhiloxKey key{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)};
      const std::uint64_t word = philox4x32({ray.tag.path, which, 0, 0}, key)[0];
      return static_cast<std::size_t>(word * queues_.size() >> 32);
    }
    case Distribute::kLoad:
      break;
  }
  std::size_t best = 0;
  for (std::size_t w = 1; w < queues_.size(); ++w)
    if (queues_[w].size + in_work_[w] < queues_[best].size + in_work_[best]) best = w;
  return best;
}

void ShadeQueues::push(const RayResult& ray, std::uint32_t shader) {
  Queue& queue = queues_[queue_for(ray)];
  const std::size_t list = sorted_ ? shader : 0;
  if (list >= queue.lists.size()) queue.lists.resize(list + 1);
  queue.lists[list].push_back({order_++, shader, ray});
  ++queue.size;
  ++size_;
}

/// The list, among those with `least` rays or more, whose first ray has waited longest; null if there is none.
Fifo<ShadeQueues::Waiting>* ShadeQueues::oldest(Queue& queue, std::size_t least) {
  Fifo<Waiting>* best = nullptr;
  for (Fifo<Waiting>& list : queue.lists)
    if (list.size() >= least && (best == nullptr || list.front().order < best->front().order)) best = &list;
  return best;
}

ShadeQueues::Waiting ShadeQueues::take_first(Queue& queue, Fifo<Waiting>& list) {
  const Waiting first = list.front();
  list.pop_front();
  --queue.size;
  --size_;
  return first;
}

bool ShadeQueues::take(std::uint32_t worker, ShadeVector& vector) {
  vector.rays.clear();
  vector.shaders.clear();
  Queue& queue = queues_[distribute_ == Distribute::kFifoFill ? 0 : worker];
  if (queue.size == 0) return false;
  Fifo<Waiting>* list = oldest(queue, lanes_);
  if (list == nullptr) list = oldest(queue, 1);
  while (!list->empty() && vector.rays.size() < lanes_) {
    const Waiting first = take_first(queue, *list);
    vector.rays.push_back(first.ray);
    vector.shaders.push_back(first.shader);
  }
  return true;
}

std::optional<RayResult> ShadeQueues::take_any() {
  Queue& longest =
      *std::max_element(queues_.begin(), queues_.end(), [](const Queue& a, const Queue& b) { return a.size < b.size; });
  if (longest.size == 0) return std::nullopt;
  return take_first(longest, *oldest(longest, 1)).ray;
}

}  // namespace carousel::ringbus::cycle
