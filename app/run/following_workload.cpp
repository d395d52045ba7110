#include "app/run/following_workload.h"

#include <algorithm>

namespace carousel::app {

namespace {

/// A ray that seeks a surface causes a shadow ray there and a bounce ray; a shadow ray goes on behind a pane.
bool comes_of(const RayTag& child, const RayTag& parent) {
  if (child.path != parent.path) return false;
  const bool shadow = child.kind == RayKind::kShadow;
  if (parent.kind == RayKind::kShadow)
    return shadow && child.bounce == parent.bounce && child.index == parent.index + 1;
  return shadow ? child.bounce == parent.bounce && child.index == 0 : child.bounce == parent.bounce + 1;
}

}  // namespace

Workload::Generated FollowingWorkload::generate(WorkerId worker, std::size_t max_rays, RayBatch& out) {
  const std::size_t before = out.size();
  const Generated made = inner_.generate(worker, max_rays, out);
  const std::lock_guard lock(mutex_);
  for (std::size_t i = before; i < out.size(); ++i) {
    // The first rays of a path: those of ours, or of another one that has got the state of ours.
    const std::uint32_t path = out[i].tag.path;
    if (locate_(path) == std::pair(place_.pixel, place_.sample))
      path_ = path;
    else if (path_ == path)
      path_.reset();
    look_at(out[i]);
  }
  return made;
}

void FollowingWorkload::look_at(const RayRequest& request) {
  const RayTag& tag = request.tag;
  if (path_ != tag.path) return;
  last_of_path_ = tag;
  if (request_ || tag.kind != place_.kind || tag.bounce != place_.bounce || tag.index != place_.index) return;
  request_ = request;
  made_ = Clock::now();
  ray_.name(tag);
}

void FollowingWorkload::shade(WorkerId worker, const HitBatch& completed, RayBatch& out) {
  const auto ours =
      std::find_if(completed.begin(), completed.end(), [&](const RayResult& r) { return ray_.is(r.tag); });
  const auto began = Clock::now();
  const std::size_t before = out.size();
  inner_.shade(worker, completed, out);
  const std::lock_guard lock(mutex_);
  if (ours != completed.end()) {
    shade_began_ = began;
    shaded_ = Clock::now();
    result_ = *ours;
    ray_.forget();  // another path may get its state
    for (std::size_t i = before; i < out.size(); ++i)
      if (comes_of(out[i].tag, ours->tag)) caused_.push_back(out[i].tag);
  }
  for (std::size_t i = before; i < out.size(); ++i) look_at(out[i]);
}

void FollowingWorkload::add_times(Clock::time_point start, std::vector<ringbus::RayFact>& facts) const {
  using Kind = ringbus::RayFact::Kind;
  const auto at = [&](Clock::time_point time) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, (time - start).count()));
  };
  if (request_) facts.push_back({.kind = Kind::kMade, .at = at(made_), .end = at(made_)});
  if (result_)
    facts.push_back({.kind = Kind::kShaded, .at = at(shade_began_), .end = at(shaded_), .hit = result_->hit});
}

}  // namespace carousel::app
