#pragma once

#include <memory>

#include "app/trace/trace_writer.h"
#include "core/system/atomic_file.h"

namespace carousel::app {

/// Chrome's JSON. A cycle stands for a microsecond; `native`: times are nanoseconds of the host. Keeps references.
std::unique_ptr<TraceWriter> chrome_trace(AtomicFile& file, const ringbus::Timeline& timeline, bool native,
                                          bool complete);

}  // namespace carousel::app
