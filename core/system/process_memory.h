#pragma once

#include <cstdint>

namespace carousel {

/// The most memory that this process has had at one time.
std::uint64_t peak_memory_bytes();

/// The memory for data that this process has, as RLIMIT_DATA counts it: whether or not it has been touched.
std::uint64_t data_memory_bytes();
/// The limit of that which the process was started with or has set; 0: there is none.
std::uint64_t data_memory_limit();
/// Sets a limit for this process; 0: back to that which it was started with. From then on it gets no more.
void limit_data_memory(std::uint64_t bytes);

}  // namespace carousel
