#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/statistics/shading_counts.h"
#include "core/types/workload.h"
#include "ringbus/cycle/shading/shade_queues.h"
#include "ringbus/cycle/shading/shading_settings.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The cycles that shader workers need, and counts of the work that they have been given. Keeps a reference to the
/// workload.
class ShadeCosts {
 public:
  ShadeCosts(const ShadingConfig& shading, const Workload& workload)
      : workload_(workload),
        shade_(static_cast<Cycle>(shading.cycles_per_shade)),
        lookup_(static_cast<Cycle>(shading.cycles_per_lookup)),
        any_hit_(static_cast<Cycle>(shading.cycles_per_any_hit)),
        products_per_cycle_(static_cast<std::uint64_t>(shading.products_per_cycle)),
        lanes_(static_cast<std::size_t>(shading.lanes)) {}

  Cycle camera_rays(std::size_t rays) const { return shade_ * ceil_div(rays, lanes_); }
  Cycle any_hit_calls(std::size_t calls) const { return any_hit_ * ceil_div(calls, lanes_); }

  /// A completed ray: its shader and the effects of its surface. Counts it as begun.
  Cycle begin(const RayResult& ray) {
    const ShadeWork work = workload_.extra_work(ray);
    counts_.products += work.products;
    counts_.lookups += work.lookups;
    const Cycle products = products_per_cycle_ == 0 ? 0 : ceil_div(work.products, products_per_cycle_);
    return shade_ + lookup_ * work.lookups + products;
  }
  /// A vector, whose shaders run one after another. Each takes as long as the longest of its rays.
  Cycle begin(const ShadeVector& vector) {
    Cycle sum = 0;
    for (std::size_t i = 0; i < vector.rays.size(); ++i) {
      // The shader has had its turn with an earlier ray.
      const auto first = vector.shaders.begin(), here = first + static_cast<std::ptrdiff_t>(i);
      if (std::find(first, here, *here) != here) continue;
      Cycle longest = 0;
      for (std::size_t j = i; j < vector.rays.size(); ++j)
        if (vector.shaders[j] == *here) longest = std::max(longest, begin(vector.rays[j]));
      sum += longest;
      ++counts_.vectors.runs;
    }
    ++counts_.vectors.vectors;
    counts_.vectors.rays += vector.rays.size();
    return sum;
  }

  /// All but the workers' time.
  const ShadingCounts& counts() const { return counts_; }

 private:
  const Workload& workload_;
  Cycle shade_, lookup_, any_hit_;
  std::uint64_t products_per_cycle_;
  std::size_t lanes_;
  ShadingCounts counts_;
};

}  // namespace carousel::ringbus::cycle
