#include "bench/common/ring_runner.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <stop_token>
#include <string_view>

#include "bench/common/list_workload.h"
#include "core/config/config.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"

namespace carousel::bench {

namespace {

[[noreturn]] void refuse(std::string_view key, std::string_view value) {
  throw ConfigError("--vary", "no setting " + std::string(key) + " of value " + std::string(value));
}

std::int64_t number(std::string_view key, std::string_view value) {
  std::int64_t out = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out);
  if (error != std::errc{} || end != value.data() + value.size() || out < 1) refuse(key, value);
  return out;
}

template <class E>
E choice(std::string_view key, std::string_view value) {
  for (const EnumName<E>& one : kEnumNames<E>)
    if (one.name == value) return one.value;
  refuse(key, value);
}

void change(RingSettings& s, std::string_view key, std::string_view value) {
  if (key == "slots")
    s.slots = number(key, value);
  else if (key == "packet-rays")
    s.packet_rays = number(key, value);
  else if (key == "ready")
    s.ready = number(key, value);
  else if (key == "capacity")
    s.capacity = number(key, value);
  else if (key == "treelet")
    s.treelet_triangles = number(key, value);
  else if (key == "link-depth")
    s.link_depth = number(key, value);
  else if (key == "policy")
    s.policy = choice<Policy>(key, value);
  else if (key == "select")
    s.select = choice<Select>(key, value);
  else if (key == "lanes")
    s.lanes = choice<Lanes>(key, value);
  else if (key == "sort")
    s.sort = choice<RaySort>(key, value);
  else if (key == "queue")
    s.queue = choice<QueueKind>(key, value);
  else
    refuse(key, value);
}

}  // namespace

RingSettings with_changes(RingSettings settings, const std::string& changes) {
  for (std::string_view rest = changes; !rest.empty();) {
    const std::string_view one = rest.substr(0, rest.find(';'));
    rest.remove_prefix(std::min(one.size() + 1, rest.size()));
    const std::size_t equals = one.find('=');
    if (equals == std::string_view::npos) refuse(one, "");
    change(settings, one.substr(0, equals), one.substr(equals + 1));
  }
  return settings;
}

Config ring_config(const RingSettings& settings, const RingForm& form, int threads) {
  Config config;
  config.engine.threads = threads;
  config.engine.lanes = settings.lanes;
  config.shading.workers = threads;
  config.topology.resources = form.resources;
  config.topology.link.depth = settings.link_depth;
  config.topology.link.queue = settings.queue;
  config.rays.slots_per_resource = settings.slots;
  config.rays.sort = settings.sort;
  config.packets.rays = settings.packet_rays;
  config.collections.ready = settings.ready;
  config.collections.capacity = settings.capacity;
  config.collections.traversal = form.traversal;
  config.collections.home = form.home;
  config.collections.policy = settings.policy;
  config.collections.select = settings.select;
  config.bundles = form.bundles;
  config.bvh.treelet_triangles = settings.treelet_triangles;
  return config;
}

RingRun run_ring(const accel::Accel& accel, float scene_size, const RingSettings& settings, const RingForm& form,
                 const RaySet& rays, int threads, HitList& hits, double limit_seconds) {
  const Config config = ring_config(settings, form, threads);
  ringbus::RunOptions options;
  options.threads = static_cast<std::size_t>(threads);
  options.statistics = form.statistics;
  options.link_statistics = form.link_statistics;
  ListWorkload workload(rays, hits);
  const auto start = std::chrono::steady_clock::now();
  std::stop_source stop;
  options.stop = stop.get_token();
  options.progress = [&](std::uint64_t) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > limit_seconds)
      stop.request_stop();
  };
  RingRun run;
  run.result = ringbus::run_native(config, accel, scene_size, workload, options);
  run.to_first_packet_seconds = std::chrono::duration<double>(workload.started() - start).count();
  return run;
}

}  // namespace carousel::bench
