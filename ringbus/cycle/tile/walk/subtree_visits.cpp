#include "ringbus/cycle/tile/walk/subtree_visits.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

void SubtreeVisits::prepare(std::size_t context, WalkSteps& ways) {
  Visit& visit = visits_[context];
  std::swap(visit.ways, ways);
  left_[context] = static_cast<std::uint32_t>(visit.ways.ends().size());
  if (timed_) visit.times.assign(left_[context], {});
  visit.inverted.clear();
}

void SubtreeVisits::begin(std::size_t context, std::uint32_t reads, Cycle now, bool loaded) {
  visits_[context].loaded = loaded;
  const std::vector<std::uint32_t>& ends = visits_[context].ways.ends();
  std::uint32_t first = 0, place = 0;
  std::uint64_t records = reads - ends.size() + 1;
  for (const std::uint32_t end : ends) {
    const std::uint32_t index = new_ray();
    if (timed_) visits_[context].times[place].strips = end - first;
    rays_[index] = {first, end, static_cast<std::uint32_t>(context), place++, Ray::Phase::kBegins};
    first = end;
    const Cycle at = tester_.read(now, records);
    records = 1;
    if (at > now)
      events_.add(now, at, index);
    else
      advance(index, now);
  }
}

std::uint32_t SubtreeVisits::new_ray() {
  if (free_rays_.empty()) {
    rays_.emplace_back();
    return static_cast<std::uint32_t>(rays_.size() - 1);
  }
  const std::uint32_t index = free_rays_.back();
  free_rays_.pop_back();
  return index;
}

/// The ray comes to its next strip, or ends.
void SubtreeVisits::advance(std::uint32_t index, Cycle now) {
  Ray& ray = rays_[index];
  Visit& visit = visits_[ray.context];
  if (ray.step == ray.end) {
    ray.phase = Ray::Phase::kFree;
    free_rays_.push_back(index);
    if (timed_) visit.times[ray.place].end = now;
    visit_ended_ |= --left_[ray.context] == 0;
    return;
  }
  if (visit.loaded) return test(index, now);
  const WalkStep& step = visit.ways[ray.step];
  const bool reads = visit.ways.transforms(step) || memory_.reads_record(step.key);
  const ShapeNeed need{memory_.has_treelets() ? memory_.treelet(step.key.ref) : memory_.strip(step.key),
                       reads ? memory_.transform(step.key.instance) : ShapeSpan{}, memory_.gaussians(step.key)};
  ray.phase = Ray::Phase::kWaits;
  if (shapes_.take(first_user_ + index, need, now)) test(index, now);
}

void SubtreeVisits::test(std::uint32_t index, Cycle now) {
  Ray& ray = rays_[index];
  Visit& visit = visits_[ray.context];
  const WalkStep& step = visit.ways[ray.step++];
  ray.phase = Ray::Phase::kInTest;
  ++in_test_;
  const Cycle end = step.has_one_kind() ? tester_.ray(now, step.kind(), step.passes()) : test_several(visit, step, now);
  if (timed_) visit.times[ray.place].in_test += end - now;
  events_.add(now, end, index);
}

/// Returns the end of tests of several kinds.
Cycle SubtreeVisits::test_several(Visit& visit, const WalkStep& step, Cycle now) {
  RayTests tests = visit.ways.tests(step);
  const std::uint8_t passes = std::exchange(tests.inversion, 0);
  if (passes == 0) return tester_.ray(now, tests);
  // The first ray that needs a matrix inverted has it done for all of the visit.
  const auto done = std::find_if(visit.inverted.begin(), visit.inverted.end(),
                                 [&](const Inverted& one) { return one.instance == step.key.instance; });
  const Cycle at = done != visit.inverted.end()
                       ? std::max(now, done->at)
                       : visit.inverted.emplace_back(Inverted{step.key.instance, tester_.invert(now, passes)}).at;
  return tester_.ray(at, tests);
}

void SubtreeVisits::run(Cycle now) {
  while (events_.next() <= now) {
    const std::uint32_t index = events_.take();
    const Ray::Phase phase = rays_[index].phase;
    if (phase == Ray::Phase::kDropped) [[unlikely]] {
      rays_[index].phase = Ray::Phase::kFree;
      free_rays_.push_back(index);
      continue;
    }
    if (phase == Ray::Phase::kInTest) {
      --in_test_;
      if (memory_.has_treelets() && has_next(rays_[index])) {
        test(index, now);
        continue;
      }
      if (!visits_[rays_[index].context].loaded) shapes_.release(first_user_ + index, now);
    }
    advance(index, now);
    if (!shapes_.ready().empty()) serve(now);
  }
}

Cycle SubtreeVisits::run_before(Cycle limit) {
  while (events_.next() < limit) {
    const Cycle now = events_.next();
    const bool tested = testing();
    run(now);
    if (tested != testing() || has_news()) return now;
  }
  return kNever;
}

void SubtreeVisits::serve(Cycle now) {
  if (shapes_.ready().empty()) return;
  for (const ShapeBuffer::User user : shapes_.ready()) {
    if (user >= first_user_)
      test(user - first_user_, now);
    else
      others_.push_back(user);
  }
  shapes_.ready().clear();
}

void SubtreeVisits::drop(std::size_t context, Cycle now) {
  for (std::uint32_t index = 0; index < rays_.size(); ++index) {
    Ray& ray = rays_[index];
    if (ray.context != context || ray.phase == Ray::Phase::kFree || ray.phase == Ray::Phase::kDropped) continue;
    shapes_.release(first_user_ + index, now);
    in_test_ -= ray.phase == Ray::Phase::kInTest;
    if (ray.phase == Ray::Phase::kWaits) {
      ray.phase = Ray::Phase::kFree;
      free_rays_.push_back(index);
    } else {
      ray.phase = Ray::Phase::kDropped;  // until its event comes
    }
  }
  left_[context] = 0;
}

}  // namespace carousel::ringbus::cycle
