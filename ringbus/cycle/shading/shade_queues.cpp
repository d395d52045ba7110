#include "ringbus/cycle/shading/shade_queues.h"

#include <algorithm>

#include "core/numeric/rng.h"

namespace carousel::ringbus::cycle {

using Distribute = ShadingConfig::Distribute;

ShadeQueues::ShadeQueues(ShadingConfig::Distribute distribute, std::size_t workers, std::uint64_t seed)
    : distribute_(distribute),
      seed_(seed),
      queues_(distribute_ == Distribute::kFifoFill ? 1 : workers),
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
    if (queues_[w].size() + in_work_[w] < queues_[best].size() + in_work_[best]) best = w;
  return best;
}

void ShadeQueues::push(const RayResult& ray) {
  queues_[queue_for(ray)].push_back(ray);
  ++size_;
}

std::optional<RayResult> ShadeQueues::take_from(std::deque<RayResult>& queue) {
  if (queue.empty()) return std::nullopt;
  const RayResult ray = queue.front();
  queue.pop_front();
  --size_;
  return ray;
}

std::optional<RayResult> ShadeQueues::take(std::uint32_t worker) {
  return take_from(queues_[distribute_ == Distribute::kFifoFill ? 0 : worker]);
}

std::optional<RayResult> ShadeQueues::take_any() {
  return take_from(*std::max_element(queues_.begin(), queues_.end(),
                                     [](const auto& a, const auto& b) { return a.size() < b.size(); }));
}

}  // namespace carousel::ringbus::cycle
