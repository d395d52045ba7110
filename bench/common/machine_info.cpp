#include "bench/common/machine_info.h"

#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include <embree3/rtcore.h>

#include "accel/traverse/kernels.h"
#include "core/system/version.h"

namespace carousel::bench {

namespace {

std::string first_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) return line.substr(line.find(": ") + 2);
  return "unknown";
}

std::string caches() {
  std::string text;
  const std::filesystem::path cpu = "/sys/devices/system/cpu/cpu0/cache";
  for (int i = 0; i < 8; ++i) {
    const std::filesystem::path index = cpu / ("index" + std::to_string(i));
    const std::string type = first_line(index / "type"), level = first_line(index / "level");
    if (type.empty() || type == "Instruction") continue;
    text += (text.empty() ? "L" : ", L") + level + (type == "Data" ? "d " : " ") + first_line(index / "size");
  }
  return text.empty() ? "unknown" : text;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

MachineInfo machine_info() {
  MachineInfo info;
  info.cpu = cpu_model();
  info.threads = static_cast<int>(std::thread::hardware_concurrency());
  info.caches = caches();
  const BuildInfo build = build_info();
  info.commit = build.commit;
  info.compiler = build.compiler;
  info.build_type = build.build_type;
  info.simd = accel::simd_targets().front();
  info.embree = RTC_VERSION_STRING;
  info.date = utc_now();
  return info;
}

}  // namespace carousel::bench
