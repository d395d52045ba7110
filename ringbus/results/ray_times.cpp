#include "ringbus/results/ray_times.h"

#include <algorithm>

namespace carousel::ringbus {

void ResourceTimes::begin_visit(const PacketHistory& history) {
  visited_ = &history;
  for (const std::uint8_t stage : stages_) whole_[stage] = 0;
  stages_.clear();
  history.since(history.begun(), resource_, [&](RayStage stage, Cycle cycles) {
    const auto i = static_cast<std::uint8_t>(stage);
    if (whole_[i] == 0) stages_.push_back(i);
    whole_[i] += cycles;
  });
}

void ResourceTimes::begin_heard_visit(const PacketHistory& history, Cycle since, Cycle begun, Cycle now) {
  heard_ = history;
  heard_.until(since, RayStage::kLink);
  heard_.tested(resource_, begun, now);
  begin_visit(heard_);
}

Cycle ResourceTimes::tested(std::uint32_t slot, const RayTag& tag, std::uint32_t joined, Cycle now) {
  Slot& ray = slots_[slot];
  const std::size_t index = RayTimeTable::index_of(tag);
  RayTimeTable::Row& row = table_.at(index);
  const auto add = [&](RayStage stage, Cycle cycles) { row[static_cast<std::size_t>(stage)] += cycles; };
  // The low half of the cycle says it all, since it was less than 2^32 cycles ago.
  const Cycle at = now - (static_cast<std::uint32_t>(now) - joined), issued = visited_->begun();
  Cycle from = ray.since;
  if (at > from) {
    add(ray.under_way ? RayStage::kHome : RayStage::kLoad, at - from);
    from = at;
  }
  ray.under_way = true;
  constexpr auto kInTest = static_cast<std::size_t>(RayStage::kTest);
  Cycle in_test = whole_[kInTest];
  if (from <= issued) {
    add(RayStage::kCollection, issued - from);
    if (index != whole_row_) add_whole();
    whole_row_ = index;
    ++whole_rays_;
  } else {
    const std::uint64_t before = row[kInTest];
    visited_->since(from, resource_, add);
    in_test = row[kInTest] - before;
  }
  ray.in_test += in_test;
  ++ray.tests;
  ray.hops += visited_->hops();
  ray.since = now;
  return in_test;
}

void ResourceTimes::add_whole() {
  if (whole_rays_ == 0) return;
  RayTimeTable::Row& row = table_.at(whole_row_);
  for (const std::uint8_t i : stages_) row[i] += whole_rays_ * whole_[i];
  whole_rays_ = 0;
}

void ResourceTimes::walked(std::uint32_t slot, const RayTag& tag, std::uint32_t strips, Cycle of, Cycle test,
                           Cycle after) {
  RayTimeTable::Row& row = table_.of(tag);
  const Cycle home = std::min(after, of), in_test = std::min(test, of - home);
  row[static_cast<std::size_t>(RayStage::kTest)] -= of - in_test;
  row[static_cast<std::size_t>(RayStage::kHome)] += home;
  row[static_cast<std::size_t>(RayStage::kShapes)] += of - home - in_test;
  slots_[slot].in_test -= of - in_test;
  slots_[slot].tests += strips - 1;
}

void RayTimes::taken(ResourceId resource, const HitBatch& rays, std::span<const std::uint32_t> slots, Cycle now) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    table_.move(rays[i].tag, RayStage::kReturn, RayStage::kShadeQueue, now);
    PixelCost* pixel = pixel_of(rays[i].tag);
    if (pixel == nullptr) continue;
    // The resource has not touched the slot since it handed the ray over.
    const ResourceTimes::Slot& slot = resources_[resource.value].of(slots[i]);
    pixel->tests += slot.tests;
    pixel->hops += slot.hops;
    pixel->in_test += slot.in_test;
  }
}

void RayTimes::shaded(const HitBatch& rays, Cycle now) {
  for (const RayResult& ray : rays) {
    table_.leave(ray.tag, RayStage::kShading, now);
    const std::size_t index = std::size_t{ray.tag.bounce} * kRayKinds + static_cast<std::size_t>(ray.tag.kind);
    if (index >= rays_.size()) rays_.resize(index + 1);
    ++rays_[index];
    if (PixelCost* pixel = pixel_of(ray.tag)) {
      pixel->cycles += now;
      ++pixel->rays;
    }
  }
}

std::vector<RayTimeRow> RayTimes::rows() const {
  std::vector<RayTimeRow> out;
  const auto add = [&](RayTimeRow& row, const RayTimeTable& from, std::size_t index) {
    if (index >= from.rows().size()) return;
    for (std::size_t i = 0; i < kCounters<RayStageCounts>.size(); ++i)
      row.stages[static_cast<RayStage>(i)] += from.rows()[index][i];
  };
  for (std::size_t index = 0; index < rays_.size(); ++index) {
    if (rays_[index] == 0) continue;
    RayTimeRow& row = out.emplace_back();
    row.kind = static_cast<RayKind>(index % kRayKinds);
    row.bounce = static_cast<std::uint8_t>(index / kRayKinds);
    row.rays = rays_[index];
    add(row, table_, index);
    for (const ResourceTimes& resource : resources_) add(row, resource.table(), index);
  }
  return out;
}

}  // namespace carousel::ringbus
