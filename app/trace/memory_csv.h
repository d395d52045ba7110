#pragma once

#include <filesystem>
#include <istream>
#include <string>

#include "ringbus/results/memory_request.h"

namespace carousel::app {

/// Requests to the memory as CSV, one a row, in the order of their cycles: cycle,kind,address,bytes. The cycle is one
/// of the engine, the kind `read` or `write`, the address is in bytes, and a request has 1 to 65,536 bytes. Throws
/// FileError.
void write_memory_csv(const std::filesystem::path& path, const ringbus::MemoryLog& requests);

/// Throws a ConfigError with the positions of the first problems, and FileError when the file cannot be read.
ringbus::MemoryLog read_memory_csv(const std::filesystem::path& path);
ringbus::MemoryLog read_memory_csv(std::istream& in, const std::string& name);

}  // namespace carousel::app
