#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <string>

#include "core/system/atomic_file.h"
#include "ringbus/results/memory_request.h"

namespace carousel::app {

/// Requests to the memory as CSV, one a row, in the order of their cycles: cycle,kind,address,bytes. The cycle is one
/// of the engine, the kind `read` or `write`, the address is in bytes, and a request has 1 to 65,536 bytes. The last
/// line counts the requests, and says so if the run was interrupted (not `complete`; core/text/list_end.h). Throws
/// FileError.
void write_memory_csv(AtomicFile& file, const ringbus::MemoryLog& requests, bool complete);

/// Most requests that a list may have.
inline constexpr std::size_t kMostRequests = 200'000'000;
/// A list without a last line that counts is read as it is. Throws a ConfigError with the positions of the first
/// problems, also for an empty list, one of more than `most` requests and one of an interrupted run, and FileError when
/// the file cannot be read.
ringbus::MemoryLog read_memory_csv(const std::filesystem::path& path);
ringbus::MemoryLog read_memory_csv(std::istream& in, const std::string& name, std::size_t most = kMostRequests);

}  // namespace carousel::app
