#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/types/aabb.h"
#include "core/types/workload.h"

namespace carousel {

/// A number that a workload of a plugin takes from `workload.options`, closed in its range.
struct WorkloadOption {
  std::string name;
  double standard = 0, least = 0, most = 1;
  std::string unit, meaning;
};

/// What a workload of a plugin is made for.
struct WorkloadSetup {
  std::size_t workers = 1;                ///< how many call it, as Workload says
  Aabb scene;                             ///< box around the scene
  std::uint64_t seed = 0;                 ///< image.seed
  std::map<std::string, double> options;  ///< every option, in its range
};

struct MadeWorkload {
  std::unique_ptr<Workload> workload;
  std::uint64_t first_rays = 0;  ///< the rays that no other ray causes, by which progress is measured
};

/// A workload that a plugin brings. It is made anew for every run, each of which must have the same rays.
struct WorkloadOffer {
  std::vector<WorkloadOption> options;
  std::function<MadeWorkload(const WorkloadSetup&)> make;
};

}  // namespace carousel
