// Notes of ray control and shading for the life of a ray, where that is asked for.
#include <algorithm>

#include "ringbus/cycle/shading/shading_agent.h"

namespace carousel::ringbus::cycle {

void ShadingAgent::note_made(std::span<const RayRequest> rays, Cycle at, Cycle end) {
  for (const RayRequest& ray : rays)
    if (recording_.ray->ray->is(ray.tag))
      recording_.ray->facts.push_back({.kind = RayFact::Kind::kMade, .at = at, .end = end, .tag = ray.tag});
}

void ShadingAgent::note_taken(const HitBatch& rays, Cycle now) {
  for (const RayResult& ray : rays) {
    if (!recording_.ray->ray->is(ray.tag)) continue;
    recording_.ray->ray->leave();
    recording_.ray->facts.push_back({.kind = RayFact::Kind::kTaken, .at = now, .end = now, .hit = ray.hit});
  }
}

/// To be called before the workload shades the rays, which may be told by it that the followed one is over.
void ShadingAgent::note_shaded(Cycle now) {
  for (const RayResult& ray : shaded_)
    if (recording_.ray->ray->is(ray.tag))
      recording_.ray->facts.push_back(
          {.kind = RayFact::Kind::kShaded, .at = shade_began_, .end = now, .hit = ray.hit, .tag = ray.tag});
}

void ShadingAgent::note_placed(RayId id, std::uint32_t home, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  RayStore& store = *machine_.stores[layout.owner(id).value];
  if (store.is_bundle(layout.slot(id)) || !recording_.ray->ray->is(store.record(layout.slot(id)).tag)) return;
  recording_.ray->ray->place(id);
  recording_.ray->facts.push_back({.kind = RayFact::Kind::kPlaced,
                                   .at = now,
                                   .resource = layout.owner(id).value,
                                   .other = home,
                                   .packet = layout.slot(id)});
}

/// A group has been sent.
void ShadingAgent::note_arrival(std::span<const RayId> ids, Cycle arrival) {
  if (recording_.ray->facts.empty() ||
      std::none_of(ids.begin(), ids.end(), [&](RayId id) { return recording_.ray->ray->is(id); }))
    return;
  RayFact& last = recording_.ray->facts.back();
  if (last.kind == RayFact::Kind::kPlaced && last.end == 0) last.end = arrival;
}

}  // namespace carousel::ringbus::cycle
