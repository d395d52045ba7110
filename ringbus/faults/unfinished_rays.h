#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "core/types/ids.h"
#include "core/types/workload.h"

namespace carousel::ringbus {

/// The error text for a resource that has stopped when rays are not to begin again; `open` as OutstandingRays::open().
inline std::string unfinished_rays(ResourceId stopped, const RayBatch& open, std::uint64_t completed) {
  std::string text = fmt::format(
      "resource {} stopped and faults.resource.recover is off: {}", stopped.value,
      open.size() == 1 ? "1 ray is missing, of path" : fmt::format("{} rays are missing, of paths", open.size()));
  constexpr std::size_t kNamed = 8;
  const std::size_t named = std::min(kNamed, open.size());
  for (std::size_t i = 0; i < named; ++i) text += fmt::format(" {}{}", open[i].tag.path, i + 1 < named ? "," : "");
  if (open.size() > kNamed) text += " and others";
  return text + fmt::format("; rays that had been shaded: {}", completed);
}

}  // namespace carousel::ringbus
