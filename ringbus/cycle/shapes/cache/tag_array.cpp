#include "ringbus/cycle/shapes/cache/tag_array.h"

#include <algorithm>

#include "ringbus/cycle/messages/memory_messages.h"

namespace carousel::ringbus::cycle {

namespace {

/// Shapes stand below; spilled entries, records and states of paths above (SpillMemory, RayData).
constexpr std::uint64_t kFirstRayData = std::uint64_t{1} << 40;

/// So many ways of an L2.
LineCache line_cache(const MemoryConfig& config, std::int64_t ways) {
  const auto line_bytes = static_cast<std::uint64_t>(config.line_bytes);
  const std::uint64_t sets =
      static_cast<std::uint64_t>(config.l2_kib) * 1024 / line_bytes / static_cast<std::uint64_t>(config.ways);
  return {sets * static_cast<std::uint64_t>(ways) * line_bytes, line_bytes, static_cast<std::uint64_t>(ways),
          line_bytes / fetched_bytes(config), config.l2_write == MemoryConfig::Write::kBack};
}

}  // namespace

TagArray::TagArray(const MemoryConfig& config)
    : ways_(line_cache(config, config.ways - config.l2_ray_ways)),
      first_ray_line_(kFirstRayData / fetched_bytes(config)) {
  if (config.l2_ray_ways > 0) ray_ways_.emplace(line_cache(config, config.l2_ray_ways));
}

std::vector<std::uint64_t> TagArray::lines() const {
  std::vector<std::uint64_t> lines = ways_.lines();
  if (ray_ways_) {
    const std::vector<std::uint64_t> others = ray_ways_->lines();
    lines.insert(lines.end(), others.begin(), others.end());
  }
  return lines;
}

std::vector<std::uint64_t> TagArray::recent() const {
  std::vector<std::uint64_t> recent = ways_.replaced();
  const std::vector<std::uint64_t> rays = ray_ways_ ? ray_ways_->replaced() : std::vector<std::uint64_t>{},
                                   here = lines();
  recent.insert(recent.end(), rays.begin(), rays.end());
  recent.insert(recent.end(), here.begin(), here.end());
  return recent;
}

std::vector<std::uint64_t> TagArray::take_written() {
  std::vector<std::uint64_t> written;
  ways_.take_written(written);
  if (ray_ways_) ray_ways_->take_written(written);
  std::sort(written.begin(), written.end());
  return written;
}

}  // namespace carousel::ringbus::cycle
