#pragma once

#include "core/config/parts/stride_prefetcher.h"
#include "core/parts/part_list.h"

namespace carousel {

/// Every part of the cycle machine that declares itself, in the order of its section in configuration and report. A new
/// part is a header in core/config/parts, its include above and its name here, and a folder in ringbus/cycle/parts
/// (docs/guides/extending.md).
using Parts = PartList<StridePrefetcherPart>;

}  // namespace carousel
