#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/types/shade_facts.h"

namespace carousel::ringbus::cycle {

/// Makes the reads those of the lines in which they lie, each once, in order.
inline void by_line(std::vector<DataRead>& reads, std::uint64_t line_bytes) {
  std::vector<DataRead> lines;
  for (const DataRead& read : reads)
    for (std::uint64_t line = read.offset / line_bytes; line * line_bytes < read.offset + read.bytes; ++line)
      lines.push_back({line * line_bytes, static_cast<std::uint32_t>(line_bytes)});
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  reads = std::move(lines);
}

}  // namespace carousel::ringbus::cycle
