#include "core/system/process_memory.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <sys/resource.h>

namespace carousel {

namespace {

rlimit data_limit() {
  rlimit limit{RLIM_INFINITY, RLIM_INFINITY};
  getrlimit(RLIMIT_DATA, &limit);
  return limit;
}

}  // namespace

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::uint64_t data_memory_bytes() {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;) {
    std::uint64_t kib = 0;
    if (word == "VmData:" && in >> kib) return kib * 1024;
  }
  return 0;
}

std::uint64_t data_memory_limit() {
  const rlim_t limit = data_limit().rlim_cur;
  return limit == RLIM_INFINITY ? 0 : limit;
}

void limit_data_memory(std::uint64_t bytes) {
  static const rlim_t first = data_limit().rlim_cur;
  rlimit limit = data_limit();
  limit.rlim_cur = bytes == 0 ? first : std::min<rlim_t>(bytes, first);
  setrlimit(RLIMIT_DATA, &limit);
}

}  // namespace carousel
