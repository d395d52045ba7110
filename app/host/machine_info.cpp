#include "app/host/machine_info.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <thread>

#include <sys/utsname.h>
#include <unistd.h>

#include "core/system/process_memory.h"

namespace carousel::app {

namespace {

std::uint64_t physical_memory_bytes() {
  const long pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGE_SIZE);
  return pages > 0 && page_bytes > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes) : 0;
}

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(": ");
    return colon == line.npos ? "" : line.substr(colon + 2);
  }
  return "";
}

std::string system_name() {
  utsname name{};
  if (uname(&name) != 0) return "";
  return std::string(name.sysname) + " " + name.release + " " + name.machine;
}

}  // namespace

report::Machine machine_info() {
  return {cpu_name(), system_name(), std::thread::hardware_concurrency(), physical_memory_bytes()};
}

std::uint64_t usable_memory_bytes() {
  std::uint64_t bytes = physical_memory_bytes();
  for (const char* path : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream in(path);
    std::uint64_t limit = 0;  // stays 0 for "max", which is no limit
    if (in >> limit && limit > 0) bytes = std::min(bytes, limit);
  }
  // If a limit was set, the bytes that libraries took of it before there was any scene are gone.
  static const std::uint64_t taken = data_memory_bytes();
  if (const std::uint64_t limit = data_memory_limit(); limit > 0)
    bytes = std::min(bytes, std::max<std::uint64_t>(limit, taken + 1) - taken);
  return bytes;
}

}  // namespace carousel::app
