#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "ringbus/schedule/schedule.h"
#include "tests/ringbus/support/scatter_workload.h"

namespace carousel::ringbus {

/// Another workload's rays with fewer numbers of paths than there are paths, so that a path takes the number of one
/// that is over, as the path states of shading do. It has points inside of shade() at which an agent may lose its turn,
/// and serves only runs under a schedule.
class ReusedPaths final : public Workload {
 public:
  /// Keeps a reference. `numbers` at least 1; `shaded(n)` is called when the n-th ray has been shaded.
  ReusedPaths(ScatterWorkload& inner, std::uint32_t numbers, std::function<void(std::uint64_t)> shaded)
      : inner_(inner), paths_(numbers), shaded_(std::move(shaded)) {
    for (std::uint32_t n = numbers; n-- > 0;) free_.push_back(n);
  }

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    const std::size_t most = std::min(max_rays, free_.size()), first = out.size();
    if (most == 0) return {};
    const Generated made = inner_.generate(worker, most, out);
    for (std::size_t i = first; i < out.size(); ++i) {
      const std::uint32_t number = free_.back();
      free_.pop_back();
      paths_[number] = {out[i].tag.path, 1};
      out[i].tag.path = number;
    }
    return made;
  }

  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    HitBatch one(1);
    for (const RayResult& ray : completed) {
      const std::uint32_t number = ray.tag.path;
      Path& path = paths_[number];
      one[0] = ray;
      one[0].tag.path = path.path;
      const std::size_t first = out.size();
      inner_.shade(worker, one, out);
      for (std::size_t i = first; i < out.size(); ++i) out[i].tag.path = number;
      path.open += static_cast<std::uint32_t>(out.size() - first);
      if (--path.open == 0) free_.push_back(number);
      shaded_(inner_.rays());
      schedule_point();
    }
  }

  HitsDigest digest() const { return inner_.digest(); }
  std::uint64_t rays() const { return inner_.rays(); }
  std::uint64_t doubled() const { return inner_.doubled(); }

 private:
  struct Path {
    std::uint32_t path = 0, open = 0;  // its number in the other workload; its rays in flight
  };
  ScatterWorkload& inner_;
  std::vector<Path> paths_;  // by number
  std::vector<std::uint32_t> free_;
  std::function<void(std::uint64_t)> shaded_;
};

}  // namespace carousel::ringbus
