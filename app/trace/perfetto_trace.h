#pragma once

#include <memory>

#include "app/trace/trace_writer.h"
#include "core/system/atomic_file.h"

namespace carousel::app {

/// False in a build without protobuf, which cannot write this format.
bool has_perfetto_trace();

/// The protobuf of Perfetto, of less than half the size of Chrome's JSON. A cycle stands for a microsecond; `native`:
/// times are nanoseconds of the host. Keeps references. Null where has_perfetto_trace() is false.
std::unique_ptr<TraceWriter> perfetto_trace(AtomicFile& file, const ringbus::Timeline& timeline, bool native,
                                            bool complete);

}  // namespace carousel::app
