#include "app/commands/follow_command.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "app/run/following_workload.h"
#include "app/run/hit_recorder.h"
#include "app/run/render_job.h"
#include "core/system/error.h"
#include "core/system/stop_request.h"
#include "core/types/enum_names.h"
#include "report/csv/ray_csv_columns.h"
#include "report/read/document.h"
#include "report/run/ray_life_table.h"
#include "report/run/report_json.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/results/ray_life.h"

namespace carousel::app {

namespace {

std::optional<std::uint32_t> number(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// True where an interrupt ended the run: nothing is known then of rays that it has not come to.
bool was_cut(const ringbus::RunResult& run, const InterruptScope& interrupt) {
  return !run.complete && interrupt.interrupted();
}

/// Row `row` of hits.csv, found by a run of its own, as only all rays together have an order.
RayPlace place_of_row(const Prepared& p, std::uint64_t row, const InterruptScope& interrupt) {
  RenderJob job(p);
  HitRecorder recorder(static_cast<std::size_t>(shader_workers(p.config())));
  job.set_recorder(&recorder);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  const ringbus::RunResult result = run(p.config(), p.accel, p.scene_size(), job.workload(), options);
  if (was_cut(result, interrupt)) throw Interrupted("the run that numbers the rays had not come to its end");
  const std::vector<report::HitRow> rows = recorder.take();
  if (row >= rows.size())
    throw ConfigError("--ray", fmt::format("found {}; expected at most {}", row, rows.size() - 1));
  const RayTag& tag = rows[row].result.tag;
  return {rows[row].pixel, rows[row].sample, tag.kind, tag.bounce, tag.index};
}

RayPlace place_of(const Prepared& p, const FollowArguments& arguments, const InterruptScope& interrupt) {
  const Config& config = p.config();
  if (arguments.ray && !arguments.pixel.empty())
    throw ConfigError("--ray", "expected either a pixel or the number of a ray");
  if (config.workload.kind == WorkloadConfig::Kind::kRaysFrom) {
    if (!arguments.ray)
      throw ConfigError("--pixel", "the rays of a list have no pixels; expected --ray with a number of the list");
    return place_of_row(p, *arguments.ray, interrupt);
  }
  if (arguments.ray) return place_of_row(p, *arguments.ray, interrupt);
  const std::size_t comma = arguments.pixel.find(',');
  const auto x = number(std::string_view(arguments.pixel).substr(0, comma)),
             y = comma == std::string::npos ? std::nullopt
                                            : number(std::string_view(arguments.pixel).substr(comma + 1));
  const auto width = static_cast<std::uint32_t>(config.image.width),
             height = static_cast<std::uint32_t>(config.image.height);
  if (!x || !y || *x >= width || *y >= height)
    throw ConfigError("--pixel",
                      fmt::format("found {}; expected X,Y with X from 0 to {} and Y from 0 to {}",
                                  arguments.pixel.empty() ? "nothing" : arguments.pixel, width - 1, height - 1));
  if (arguments.sample >= static_cast<std::uint32_t>(config.image.samples))
    throw ConfigError("--sample",
                      fmt::format("found {}; expected 0 to {}", arguments.sample, config.image.samples - 1));
  if (arguments.bounce >= static_cast<std::uint32_t>(config.image.max_depth))
    throw ConfigError("--bounce", fmt::format("found {}; expected 0 to {}, below image.max_depth", arguments.bounce,
                                              config.image.max_depth - 1));
  const RayKind kind = arguments.shadow        ? RayKind::kShadow
                       : arguments.bounce == 0 ? RayKind::kCamera
                                               : RayKind::kBounce;
  return {*y * width + *x, arguments.sample, kind, static_cast<std::uint8_t>(arguments.bounce), 0};
}

std::string node_text(accel::NodeKey key) {
  const auto ref = key.ref;
  const std::string name = fmt::format("{} {:x}", ref.is_inner() ? "node" : "leaf", ref.bits());
  return key.instance == kNoInstance ? name : fmt::format("{}/{}", key.instance, name);
}

class LifeReport {
 public:
  LifeReport(const Prepared& p, const ringbus::RayLife& life) : config_(p.config()), life_(life) {}

  report::RayLife section(const RayPlace& place, const FollowingWorkload& workload) const {
    report::RayLife out;
    out.engine = enum_name(config_.engine.kind);
    out.unit = cycles() ? "cycles" : "seconds";
    out.ray = name(place, place.kind, place.bounce, place.index);
    for (int axis = 0; axis < 3; ++axis) {
      out.origin[static_cast<std::size_t>(axis)] = workload.request()->ray.origin[axis];
      out.direction[static_cast<std::size_t>(axis)] = workload.request()->ray.direction[axis];
    }
    out.begin = time(life_.begin);
    out.end = time(life_.end);
    out.latency = time(life_.end - life_.begin);
    out.complete = life_.complete;
    if (life_.resource) out.resource = *life_.resource;
    if (life_.slot) out.slot = *life_.slot;
    out.packets = life_.packets;
    out.hops = life_.hops;
    if (workload.result() && workload.result()->hit.valid()) {
      const Hit& hit = workload.result()->hit;
      out.occluded = place.kind == RayKind::kShadow;
      if (!out.occluded) out.hit = hit_of(hit);
    }
    stages(out);
    for (const ringbus::LifeTest& test : life_.tests)
      out.tests.push_back({time(test.at), test.resource, test.packet, node_text(test.key),
                           test.packet ? std::optional<std::uint64_t>(test.depth) : std::nullopt,
                           static_cast<std::uint64_t>(test.shapes),
                           test.hit ? std::optional(static_cast<std::uint64_t>(*test.hit)) : std::nullopt,
                           test.found ? std::optional(hit_of(*test.found)) : std::nullopt});
    for (const RayTag& tag : workload.caused()) out.caused.push_back(name(place, tag.kind, tag.bounce, tag.index));
    return out;
  }

 private:
  bool cycles() const { return config_.engine.kind == EngineKind::kCycle; }
  static report::RayHit hit_of(const Hit& hit) { return {hit.t, hit.instance, hit.primitive}; }
  double time(std::uint64_t at) const { return static_cast<double>(at) * (cycles() ? 1 : 1e-9); }
  report::RayName name(const RayPlace& at, RayKind kind, std::uint32_t bounce, std::uint32_t index) const {
    const bool list = config_.workload.kind == WorkloadConfig::Kind::kRaysFrom;
    const auto width = list ? ~0u : static_cast<std::uint32_t>(config_.image.width);
    return {at.pixel % width,
            at.pixel / width,
            at.sample,
            bounce,
            index,
            std::string(report::kRayKindNames[static_cast<std::size_t>(kind)])};
  }
  void stages(report::RayLife& out) const {
    std::map<ringbus::LifeStage, report::RayStageSum> sums;
    for (const ringbus::LifeSpan& span : life_.spans) {
      const std::string stage(ringbus::stage_text(span.stage));
      out.spans.push_back({time(span.begin), time(span.end - span.begin), stage, span.part, span.packet,
                           span.key ? std::optional(node_text(*span.key)) : std::nullopt});
      report::RayStageSum& sum = sums[span.stage];
      sum.stage = stage;
      sum.length += out.spans.back().length;
      ++sum.times;
    }
    for (auto& [stage, sum] : sums) {
      sum.share = out.latency > 0 ? sum.length / out.latency : 0;
      out.stages.push_back(sum);
    }
    std::stable_sort(out.stages.begin(), out.stages.end(),
                     [](const auto& a, const auto& b) { return a.length > b.length; });
  }

  const Config& config_;
  const ringbus::RayLife& life_;
};

std::string absent_text(const FollowingWorkload& workload) {
  if (!workload.last_of_path()) return "no path of this pixel and sample has any ray";
  const RayTag& last = *workload.last_of_path();
  return fmt::format("there is no such ray: the last one of this path that was made is a {} ray of bounce {}",
                     report::kRayKindNames[static_cast<std::size_t>(last.kind)], last.bounce);
}

}  // namespace

int follow_command(const FollowArguments& arguments) {
  const InterruptScope interrupt;
  const Prepared p = prepare(arguments, {}, arguments.ray.has_value());
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic)
    throw ConfigError("workload", "synthetic traffic has no rays; expected workload: rays, or the rays of a file");
  if (p.config().workload.kind == WorkloadConfig::Kind::kMemoryTrace)
    throw ConfigError("workload", "memory requests have no rays; expected workload: rays, or the rays of a file");
  if (p.config().workload.kind == WorkloadConfig::Kind::kPlugin)
    throw ConfigError("workload",
                      "the program does not know the paths of a plugin's rays; expected workload: rays, or "
                      "the rays of a file");
  if (p.config().bundles.size > 0)
    throw ConfigError("bundles.size", fmt::format("found {}; follow knows rays by themselves only; expected 0",
                                                  p.config().bundles.size));
  if (const Placement placement = p.config().rays.placement;
      p.config().engine.kind == EngineKind::kCycle &&
      (placement == Placement::kFirstTaker || placement == Placement::kAddressed))
    throw ConfigError("rays.placement",
                      fmt::format("found {}; follow does not see new rays on their way to a slot; expected "
                                  "balanced or round_robin",
                                  enum_name(placement)));
  const RayPlace place = place_of(p, arguments, interrupt);
  RenderJob job(p);
  ringbus::FollowedRay ray;
  FollowingWorkload workload(
      job.workload(), place, [&](std::uint32_t path) { return job.place_of(path); }, ray);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.ray = &ray;
  const bool native = p.config().engine.kind == EngineKind::kNative;
  ringbus::RunResult result =
      (native ? ringbus::run_native : ringbus::run_cycle)(p.config(), p.accel, p.scene_size(), workload, options);
  const bool cut = was_cut(result, interrupt);
  if (cut && !workload.request()) throw Interrupted("the ray had not been made");
  if (!workload.request()) throw ConfigError(arguments.shadow ? "--shadow" : "--bounce", absent_text(workload));
  if (native) workload.add_times(result.start, result.facts);
  const std::optional<ringbus::RayLife> life = ringbus::ray_life(result.facts, *result.timeline, p.accel);
  if (cut && !life) throw Interrupted("the ray had just been made");
  if (!life) throw SimulationError("the followed ray left no trace");
  const report::RayLife section = LifeReport(p, *life).section(place, workload);
  print_result(arguments.json ? report::json_text(report::sealed(report::ray_life_json(section))) + "\n"
                              : report::ray_life_table(section));
  if (life->complete) return kDone;
  spdlog::warn("interrupted; the life of the ray is told as far as it had come");
  return interrupt.status();
}

}  // namespace carousel::app
