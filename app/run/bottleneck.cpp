#include "app/run/bottleneck.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/numeric/worth_naming.h"
#include "report/run/judge_gains.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "ringbus/verdict/cold_caches.h"
#include "ringbus/verdict/progress_blocks.h"
#include "ringbus/verdict/search_choices.h"
#include "ringbus/verdict/small_frame.h"

namespace carousel::app {

namespace {

/// Adds what the paths of each piece took in the run: its cycles, and the busy cycles of the two busiest classes. Rays
/// complete about in the order in which their paths begin, so a piece has its share of the rays in this order.
void add_times(RenderJob::PieceWork& work, const RenderJob& job, const ringbus::RunResult& run) {
  const ringbus::cycle::CycleResult& result = *run.cycle;
  std::vector<std::size_t> classes(result.uses.size());
  std::iota(classes.begin(), classes.end(), 0);
  std::stable_sort(classes.begin(), classes.end(), [&](std::size_t a, std::size_t b) {
    return ringbus::busy(result, result.uses[a].name) > ringbus::busy(result, result.uses[b].name);
  });
  classes.resize(std::min<std::size_t>(classes.size(), 2));
  using Piece = RenderJob::PieceWork::value_type;
  const auto reached = [&](double rays) {
    const auto at = [&](const auto& value) {
      return ringbus::at_count(result, static_cast<std::uint64_t>(rays), value);
    };
    Piece out{};
    out[RenderJob::kTraced] = at(ringbus::cycle_of);
    for (std::size_t k = 0; k < classes.size(); ++k)
      out[RenderJob::kTraced + 1 + k] =
          at([&](const ringbus::cycle::ProgressSample& s) { return static_cast<double>(s.busy[classes[k]]); });
    return out;
  };
  double paths = 0, rays = 0;
  for (const Piece& piece : work) {
    paths += piece[0];
    rays += piece[1];
  }
  const double scale = static_cast<double>(run.rays_completed) / std::max(1.0, rays) * paths /
                       static_cast<double>(std::max<std::uint64_t>(1, job.first_rays()));
  double done = 0;
  Piece before = reached(0);
  for (std::uint64_t begin = 0, end = 0; begin < job.first_rays(); begin = end) {
    Piece& piece = work[job.piece_at(begin)];
    for (end = begin; end < job.first_rays() && &work[job.piece_at(end)] == &piece;) ++end;
    if (piece[0] <= 0) continue;
    const double count = static_cast<double>(end - begin);
    done += scale * count * piece[1] / piece[0];
    const Piece now = reached(done);
    for (std::size_t i = RenderJob::kTraced; i < piece.size(); ++i) piece[i] += (now[i] - before[i]) * piece[0] / count;
    before = now;
  }
}

/// The places of a frame's pilots, drawn once for each size and draw so that their work is most like that of the frame.
class PilotPlaces {
 public:
  /// Keeps references to its arguments.
  PilotPlaces(const Prepared& prepared, const RenderJob& job, const ringbus::RunResult& run)
      : prepared_(prepared), job_(job), run_(run) {}

  /// `more`: as PilotFactory. Null if that is the whole frame. Several threads may call.
  const shading::PathSample* of(std::uint64_t paths, std::uint64_t more, std::uint64_t draw) {
    if (paths >= job_.first_rays()) return nullptr;
    const std::lock_guard lock(mutex_);
    const Config& config = prepared_.config();
    const auto seed = static_cast<std::uint64_t>(config.image.seed);
    if (job_.divisible() && work_.empty()) {
      work_ = job_.survey(prepared_, config, job_.first_hits(), kOneIn, kLeastPaths, seed);
      add_times(work_, job_, run_);
    }
    auto at = samples_.find({paths, more, draw});
    if (at == samples_.end()) {
      const std::uint64_t slots = ringbus::slots_of(config);
      shading::PathSample sample = job_.draw(paths, slots, seed, work_, draw);
      if (more > 0) sample = shading::followed_by(sample, job_.draw(paths, slots, seed, {}, draw + kOthers), more);
      at = samples_.emplace(std::tuple(paths, more, draw), std::move(sample)).first;
    }
    return &at->second;
  }

 private:
  static constexpr std::uint64_t kOneIn = 16, kLeastPaths = 1 << 14;  // that the survey traces
  static constexpr std::uint64_t kOthers = 1 << 20;                   // a draw that no search comes to

  const Prepared& prepared_;
  const RenderJob& job_;
  const ringbus::RunResult& run_;
  std::mutex mutex_;
  RenderJob::PieceWork work_;
  std::map<std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>, shading::PathSample> samples_;  // by what of() has
};

/// Some of the rays of a render job alone, or all of them; their picture is thrown away.
class PilotWorkload final : public Workload {
 public:
  /// `sample` must outlive the workload; null: all rays.
  PilotWorkload(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits,
                const shading::PathSample* sample)
      : job_(prepared, config, first_hits) {
    if (sample != nullptr) job_.set_sample(sample);
  }
  ShadeWork extra_work(const RayResult& result) const override { return job_.workload().extra_work(result); }
  std::uint32_t shader(const RayResult& result) const override { return job_.workload().shader(result); }
  ShadeFacts shade_facts(const RayResult& result) const override { return job_.workload().shade_facts(result); }
  ShadeFacts any_hit_facts(const RayResult& call) const override { return job_.workload().any_hit_facts(call); }
  void sky_reads(const RayResult& result, std::vector<SkyRead>& out) const override {
    job_.workload().sky_reads(result, out);
  }
  PathMemory path_memory(const RayTag& tag) const override { return job_.workload().path_memory(tag); }
  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    return job_.workload().generate(worker, max_rays, out);
  }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    job_.workload().shade(worker, completed, out);
  }

 private:
  RenderJob job_;
};

std::optional<report::CycleNoise> noise_of(const ringbus::Bottleneck& found, const ringbus::RunResult& run) {
  if (!found.noise) return std::nullopt;
  const double cycles = static_cast<double>(run.cycle->cycles), f = found.noise->fraction;
  return report::CycleNoise{f,
                            static_cast<std::uint64_t>(std::floor(cycles * std::max(0.0, 1 - f))),
                            static_cast<std::uint64_t>(std::ceil(cycles * (1 + f))),
                            found.noise->seeds,
                            found.noise_paths,
                            found.noise->whole};
}

/// A frame that is too small for a verdict, with what the run's ledger tells all the same.
report::FrameTooSmall too_small(const ringbus::RunResult& run, const ringbus::SmallFrame& small, bool search) {
  report::FrameTooSmall out{.paths = small.paths,
                            .slots = small.slots,
                            .between = small.between,
                            .search = search,
                            .least_paths = small.least_paths};
  for (const ringbus::cycle::ClassUse& use : run.cycle->uses)
    if (const double busy = ringbus::busy(*run.cycle, use.name); use.parts > 0 && busy > out.busy) {
      out.busiest = use.name;
      out.busy = busy;
    }
  return out;
}

}  // namespace

report::Bottleneck find_bottleneck(const Prepared& prepared, const RenderJob& job, const ringbus::SearchedRun& searched,
                                   std::stop_token stop, bool quiet, std::optional<report::CycleNoise>& noise) {
  const ringbus::RunResult& run = searched.result;
  if (!run.complete) return report::judge_gains({.complete = false});
  const std::uint64_t slots = ringbus::slots_of(prepared.config());
  if (auto small = ringbus::small_frame(*run.cycle, run.rays_completed, job.first_rays(), slots)) {
    small->least_paths =
        std::max(small->least_paths, ringbus::least_paths_to_search(prepared.config(), prepared.accel, searched));
    return report::judge_gains({.frame_too_small = too_small(run, *small, false)});
  }
  ringbus::RunOptions options;
  options.threads = prepared.threads_beside;
  spdlog::debug("search: up to {} simulations at once", options.threads);
  options.stop = std::move(stop);
  options.statistics = false;
  std::optional<report::ProgressLine> line;
  if (!quiet) line.emplace(stderr);
  const auto show = [&](const ringbus::SearchProgress& at) {
    if (!line) return;
    const double under_way = report::ratio(at.under_way, at.rays);
    line->update(std::min(1.0, (static_cast<double>(at.done) + under_way) / static_cast<double>(at.of)), at.completed,
                 "rays", fmt::format("bottleneck, {}, {} of {} simulations done", at.stage, at.done, at.of));
  };
  PilotPlaces places(prepared, job, run);
  const ringbus::Bottleneck found = ringbus::find_bottleneck(
      prepared.config(), prepared.accel, prepared.scene_size(),
      [&](const Config& machine, std::uint64_t paths, std::uint64_t more, std::uint64_t draw) {
        return std::make_unique<PilotWorkload>(
            prepared, machine, machine.image.seed == prepared.config().image.seed ? job.first_hits() : nullptr,
            places.of(paths, more, draw));
      },
      searched, options, show);
  noise = noise_of(found, run);
  if (found.least_paths > 0)
    return report::judge_gains(
        {.frame_too_small = too_small(
             run,
             {job.first_rays(), slots, ringbus::part_between(*run.cycle, run.rays_completed, slots), found.least_paths},
             true)});
  spdlog::debug("search: simulated {} rays, which took {:.2f} times the run", found.simulated, found.taken);
  if (found.whole)
    spdlog::debug("search: the pilot is the whole frame, {} rays", found.rays);
  else
    spdlog::debug("search: a pilot of {} of {} paths, {} rays; its forecast is off by {:.1f} %, uncertainty {:.1f} %",
                  found.paths, job.first_rays(), found.rays, 100 * found.deviation, 100 * found.uncertainty);
  if (!found.unlike.empty()) spdlog::debug("search: gives up: {}", found.unlike);
  report::Bottleneck out{.complete = found.complete,
                         .unlike = found.unlike,
                         .rays_per_kilocycle = found.rays_per_kilocycle,
                         .noise = found.uncertainty,
                         .deviation = found.deviation,
                         .whole_frame = found.whole,
                         .paths = found.paths,
                         .rays = found.rays};
  for (const ringbus::Untried& one : found.untried) out.untried.push_back({one.name, one.action, one.why});
  for (const ringbus::Gain& gain : found.gains)
    out.gains.push_back({gain.name, gain.action, gain.sets, gain.rays_per_kilocycle, gain.gain, gain.low, gain.high,
                         gain.together, gain.frame});
  for (const ringbus::GainPhase& phase : found.phases)
    out.phases.push_back({phase.begin, phase.end, phase.time, phase.name, phase.action, phase.gain});
  const ringbus::MemoryReads reads = ringbus::reads_between(*run.cycle, slots);
  const bool cold = reads.first_share() >= ringbus::kColdShare;
  const auto fades = [&](const std::string& part) { return cold && ringbus::gains_of_cold_caches(part); };
  report::Bottleneck judged = report::judge_gains(std::move(out), fades);
  if (!fades(judged.limits)) return judged;
  judged.cold_caches = report::ColdCaches{reads.reads, reads.first};
  const auto memory = std::find_if(judged.gains.begin(), judged.gains.end(),
                                   [&](const report::BottleneckGain& gain) { return gain.name == judged.limits; });
  std::vector<ringbus::WarmGain> others;
  for (const report::BottleneckGain& gain : judged.gains) {
    if (ringbus::gains_of_cold_caches(gain.name) || gain.together != 1 || !worth_naming(gain.gain, gain.low)) continue;
    others.push_back({gain.gain, gain.low});
    if (judged.cold_caches->when_warm.empty()) judged.cold_caches->when_warm = gain.name;
  }
  if (ringbus::best_when_warm({memory->gain, memory->low}, reads.first_share(), others))
    judged.cold_caches->when_warm = memory->name;
  return report::judge_gains(std::move(judged), fades);
}

report::Bound bound_of(const ringbus::RunResult& result) {
  const ringbus::cycle::CycleResult& c = *result.cycle;
  const double rays = static_cast<double>(result.rays_completed);
  report::Bound out;
  for (const ringbus::cycle::ClassUse& use : c.uses)
    if (use.busy > 0 && use.parts > 0)
      out.classes.push_back({std::string(use.name), 1000 * rays * use.parts / static_cast<double>(use.busy)});
  std::stable_sort(out.classes.begin(), out.classes.end(),
                   [](const auto& a, const auto& b) { return a.rays_per_kilocycle < b.rays_per_kilocycle; });
  if (out.classes.empty()) return out;
  out.rays_per_kilocycle = out.classes.front().rays_per_kilocycle;
  out.reached = report::ratio(1000 * rays / static_cast<double>(c.cycles), out.rays_per_kilocycle);
  return out;
}

}  // namespace carousel::app
