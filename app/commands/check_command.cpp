#include "app/commands/check_command.h"

#include <filesystem>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/host/exit_status.h"
#include "app/host/machine_info.h"
#include "app/host/output.h"
#include "app/run/memory_need.h"
#include "app/trace/memory_csv.h"
#include "core/config/write.h"
#include "report/csv/ray_csv.h"
#include "report/text/number_text.h"
#include "ringbus/protocol/deadlock.h"

namespace carousel::app {

namespace {

std::string commented(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) out += "# " + line + "\n";
  return out;
}

/// Reads the list, so that its errors are found here as well.
std::string ray_list_text(const Prepared& p) {
  const std::filesystem::path path = find_beside(p.config_folder, p.config().workload.rays_from);
  return fmt::format("rays: {} of {}\n", report::read_rays_csv(path).size(), path.string());
}

}  // namespace

int check_command(const CheckArguments& arguments) {
  // A topology that can deadlock gets its verdict here instead of a plain refusal.
  const Prepared p = prepare(arguments, {.force = true, .ranks = true}, false);
  const ringbus::DeadlockVerdict verdict = ringbus::deadlock_verdict(p.config().topology);
  std::string text;
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic) {
    text = "scene: none, synthetic traffic\n";
  } else if (p.config().workload.kind == WorkloadConfig::Kind::kMemoryTrace) {
    const std::filesystem::path path = find_beside(p.config_folder, p.config().workload.memory_trace);
    text = fmt::format("scene: none, {} memory requests of {}\n", read_memory_csv(path).size(), path.string());
  } else {
    text = fmt::format("scene: {}, {} triangles, {} instances\n", p.scene.name, p.scene.unique_triangle_count(),
                       p.scene.instances.size());
    if (p.config().workload.kind == WorkloadConfig::Kind::kRaysFrom) text += ray_list_text(p);
    text += memory_text(estimate(p.config(), false, p.scene, p.accel), usable_memory_bytes());
    text +=
        fmt::format("build: about {} for the structure and the work on it\n", report::bytes_text(build_bytes(p.scene)));
  }
  if (const std::vector<IgnoredKey> ignored = p.ignored(); !ignored.empty())
    text += fmt::format("ignored: {}\n", ignored_text(ignored));
  text += fmt::format("deadlock: {}. {}\n", verdict.can_deadlock ? "possible" : "impossible", verdict.rule);
  print_result(resolved_yaml(p.absolute_config()) + "\n" + commented(text));
  if (!verdict.can_deadlock) return kDone;
  spdlog::error("{}: topology.flow: the links of this machine can fill up and stop, and run refuses it without --force",
                arguments.config);
  return kUsage;
}

}  // namespace carousel::app
