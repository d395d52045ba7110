#include "ringbus/cycle/shading/shading_recorder.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

void ShadingRecorder::note_made(std::span<const RayRequest> rays, Cycle at, Cycle end) {
  for (const RayRequest& ray : rays)
    if (log_->ray->is(ray.tag))
      log_->facts.push_back({.kind = RayFact::Kind::kMade, .at = at, .end = end, .tag = ray.tag});
}

void ShadingRecorder::note_taken(const HitBatch& rays, Cycle now) {
  for (const RayResult& ray : rays) {
    if (!log_->ray->is(ray.tag)) continue;
    log_->ray->leave();
    log_->facts.push_back({.kind = RayFact::Kind::kTaken, .at = now, .end = now, .hit = ray.hit});
  }
}

void ShadingRecorder::note_shaded(const HitBatch& rays, Cycle now) {
  for (const RayResult& ray : rays)
    if (log_->ray->is(ray.tag))
      log_->facts.push_back(
          {.kind = RayFact::Kind::kShaded, .at = shade_began_, .end = now, .hit = ray.hit, .tag = ray.tag});
}

void ShadingRecorder::account_for(RayId id, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  const ResourceId owner = layout.owner(id);
  times_->placed(owner, layout.slot(id), machine_.stores[owner.value]->record(layout.slot(id)).tag, now);
}

void ShadingRecorder::note_placed(RayId id, std::uint32_t home, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  RayStore& store = *machine_.stores[layout.owner(id).value];
  if (store.is_bundle(layout.slot(id)) || !log_->ray->is(store.record(layout.slot(id)).tag)) return;
  log_->ray->place(id);
  log_->facts.push_back({.kind = RayFact::Kind::kPlaced,
                         .at = now,
                         .resource = layout.owner(id).value,
                         .other = home,
                         .packet = layout.slot(id)});
}

void ShadingRecorder::note_sent(std::span<const RayId> ids, Cycle arrival) {
  if (log_->facts.empty() || std::none_of(ids.begin(), ids.end(), [&](RayId id) { return log_->ray->is(id); })) return;
  RayFact& last = log_->facts.back();
  if (last.kind == RayFact::Kind::kPlaced && last.end == 0) last.end = arrival;
}

}  // namespace carousel::ringbus::cycle
