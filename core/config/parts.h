#pragma once

#include "core/parts/part_list.h"
#include "ringbus/cycle/parts/stride_prefetcher/part.h"

namespace carousel {

/// Every part of the cycle machine that declares itself, in the order of its section in configuration and report. A new
/// part is a folder in ringbus/cycle/parts, its include above, and its name here (docs/guides/extending.md).
using Parts = PartList<StridePrefetcherPart>;

}  // namespace carousel
