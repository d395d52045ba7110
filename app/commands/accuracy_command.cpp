#include "app/commands/accuracy_command.h"

#include <algorithm>
#include <deque>
#include <optional>

#include "accel/traverse/exact_reference.h"
#include "app/accuracy/exact_answers.h"
#include "app/accuracy/hard_scenes.h"
#include "app/accuracy/level_trial.h"
#include "app/accuracy/pictures.h"
#include "app/accuracy/sensible_levels.h"
#include "app/accuracy/unit_cost.h"
#include "app/host/cpu_time.h"
#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/machine_info.h"
#include "app/host/output.h"
#include "app/host/output_folder.h"
#include "core/config/config.h"
#include "core/config/write.h"
#include "core/system/atomic_file.h"
#include "core/types/enum_names.h"
#include "report/accuracy/accuracy_summary.h"
#include "report/accuracy/accuracy_table.h"
#include "report/html/studies/study_pages.h"
#include "report/read/document.h"
#include "report/text/progress_line.h"
#include "ringbus/verdict/what_if.h"

namespace carousel::app {

namespace {

/// The number of camera rays that a picture may take; larger pictures are shrunk.
constexpr std::int64_t kCameraRays = 20000, kSampledPixels = 48 * 48;
constexpr std::size_t kModelledRays = 50000;
constexpr int kSamplingSeeds = 4;

/// Shrinks the picture to at most `pixels`, with its shape unchanged.
void shrink(ImageConfig& image, std::int64_t pixels) {
  while (image.width * image.height > pixels) {
    image.width = std::max<std::int64_t>(1, image.width * 3 / 4);
    image.height = std::max<std::int64_t>(1, image.height * 3 / 4);
  }
}

/// Every n-th of the traced rays, `wanted` of them.
RayBatch choose_rays(const std::vector<report::HitRow>& rows, std::size_t wanted) {
  RayBatch rays;
  const std::size_t count = std::min(wanted, rows.size());
  for (std::size_t i = 0; i < count; ++i) {
    const RayResult& result = rows[i * rows.size() / count].result;
    rays.push_back({result.ray, result.tag});
    rays.back().tag.path = static_cast<std::uint32_t>(i);
  }
  return rays;
}

/// One run of the command, stage by stage. It can be stopped between stages; the tables then hold the finished stages.
class Trial {
 public:
  Trial(const Prepared& prepared, const AccuracyArguments& arguments, const InterruptScope& interrupt)
      : p_(prepared),
        arguments_(arguments),
        interrupt_(interrupt),
        small_(prepared.config()),
        accel_(p_.scene, p_.config(), small_.bvh, p_.accel.any_hit),
        lifted_(ringbus::tester_limited(p_.config())),
        exact_(p_.scene, p_.accel.any_hit) {
    if (!p_.scene.programs.empty())
      throw ConfigError("scene.objects", "exact arithmetic knows no hits of programs; expected none with this command");
    if (!arguments.quiet) progress_.emplace(stderr);
    small_.image.samples = std::min<std::int64_t>(small_.image.samples, 4);
    shrink(small_.image, kCameraRays / small_.image.samples);
    if (p_.accel.any_hit != nullptr) exact_opacity_.emplace(p_.scene, *p_.accel.any_hit);
    out_.scene = p_.scene.name;
    out_.triangles = p_.scene.instanced_triangle_count();
    out_.instances = p_.scene.instances.size();
    out_.seed = arguments.seed;
    out_.repetitions = arguments.repetitions;
    out_.seeds = arguments.seeds;
    out_.width = static_cast<std::uint64_t>(small_.image.width);
    out_.height = static_cast<std::uint64_t>(small_.image.height);
    out_.samples = static_cast<std::uint64_t>(small_.image.samples);
    out_.machine = machine_info().cpu;
    out_.planes = p_.config().cull_planes.count > 0;
    out_.bundles = p_.config().bundles.size > 0;
  }

  report::Accuracy run() {
    levels_ = sensible_levels(p_.scene, small_.accuracy);
    steps_ = 6 + 2 * levels_.size();
    std::vector<report::HitRow> rows;
    const Picture exact_picture = render_exact(p_.scene, small_, exact_);
    done();
    render(p_.scene, small_, accel_.at(small_.accuracy), &rows);
    rays_ = choose_rays(rows, arguments_.rays);
    make_pictures(std::move(rows));
    out_.rays = rays_.size();
    done();
    make_hard();
    try_levels(exact_picture);
    try_spawn(exact_picture);
    try_samples();
    report::compare_costs(out_.rows);
    report::mark_frontier(out_.rows);
    for (const report::Clock clock : report::kClocks)
      out_.recommended[static_cast<std::size_t>(clock)] = report::recommended(out_.rows, clock);
    out_.verdict = report::accuracy_verdict(out_.rows);
    out_.incomplete = stopped();
    progress_.reset();
    return std::move(out_);
  }

 private:
  bool stopped() const { return interrupt_.interrupted(); }
  void done() {
    ++step_;
    if (progress_) progress_->update(static_cast<double>(step_) / static_cast<double>(steps_), step_, "stages");
  }

  /// The rays of some seeds of the picture, for the simulated machines: together no more than kModelledRays, and of
  /// each all that are asked for if these are few, since a machine that is hardly filled tells nothing of its testers.
  void make_pictures(std::vector<report::HitRow> rows) {
    const auto seeds = static_cast<std::size_t>(arguments_.seeds);
    const std::size_t wanted = std::min(arguments_.rays, kModelledRays / seeds);
    for (std::size_t seed = 0; seed < seeds && !stopped(); ++seed) {
      if (seed > 0) {
        Config config = small_;
        config.image.seed += static_cast<std::int64_t>(seed);
        rows.clear();
        render(p_.scene, config, accel_.at(small_.accuracy), &rows);
      }
      pictures_.push_back(choose_rays(rows, wanted));
    }
  }

  void make_hard() {
    hard_ = hard_scenes(arguments_.hard_rays, arguments_.seed);
    for (const HardScene& scene : hard_) {
      out_.hard.push_back(scene.about);
      hard_accels_.emplace_back(scene.scene, p_.config(), BvhConfig{}, nullptr);
      hard_exact_.push_back(exact_answers(accel::ExactReference(scene.scene), scene.rays));
    }
    done();
  }

  void try_levels(const Picture& exact_picture) {
    const std::vector<accel::ExactHit> exact = exact_answers(exact_, rays_);
    const std::vector<report::Spread> times =
        time_levels(accel_, levels_, rays_, arguments_.repetitions, [&] { return stopped(); });
    done();
    for (std::size_t i = 0; i < levels_.size() && !stopped(); ++i) {
      const AccuracyConfig& levels = levels_[i];
      report::AccuracyRow& row = out_.rows.emplace_back();
      row.triangle = enum_name(levels.triangle), row.box = enum_name(levels.box),
      row.transform = enum_name(levels.transform);
      row.ns_per_ray = times[i];
      const accel::Accel& accel = accel_.at(levels);
      HitList hits = trace(accel, rays_);
      std::uint64_t of_opacity = 0;
      if (exact_opacity_) of_opacity = settle_opacity(accel_.at(levels, &*exact_opacity_), rays_, exact, hits);
      row.scene = compare(rays_, hits, exact);
      row.scene.opacity = of_opacity;
      accel_.at(levels);
      row.picture = compare(render(p_.scene, small_, accel), exact_picture);
      done();
      row.modelled = modelled_cost(p_.config(), lifted_, accel, p_.scene_size(), pictures_);
      row.cull_planes = planes_fit(p_.config(), levels);
      row.unit_area_mm2 = unit_area_mm2(p_.config().testers, levels);
      row.relative_area = row.unit_area_mm2 / unit_area_mm2(p_.config().testers, {});
      for (std::size_t h = 0; h < hard_.size(); ++h) {
        row.hard.push_back(compare(hard_[h].rays, trace(hard_accels_[h].at(levels), hard_[h].rays), hard_exact_[h]));
        if (hard_[h].about.closed) row.leaks += row.hard.back().missed;
      }
      report::judge_safety(row, out_.hard);
      done();
    }
  }

  void try_spawn(const Picture& exact_picture) {
    for (const SpawnOffset spawn : {SpawnOffset::kEpsilon, SpawnOffset::kUlp, SpawnOffset::kBound}) {
      if (stopped()) return;
      Config config = small_;
      config.accuracy.spawn = spawn;
      std::vector<report::HitRow> rows;
      const Picture picture = render(p_.scene, config, accel_.at(small_.accuracy), &rows);
      const SelfHits here = count_self_hits(p_.scene, std::move(rows));
      const SelfHits far = self_hits_far_away(spawn, arguments_.hard_rays, arguments_.seed);
      out_.spawn.push_back({std::string(enum_name(spawn)), here.bounces, here.self_hits, far.bounces, far.self_hits,
                            compare(picture, exact_picture)});
    }
    done();
  }

  /// Compares pictures of few samples and several seeds with one of many samples and another seed.
  void try_samples() {
    Config config = small_;
    shrink(config.image, kSampledPixels);
    config.image.samples = 512;
    config.image.seed = small_.image.seed + kSamplingSeeds;
    const accel::Accel& accel = accel_.at(small_.accuracy);
    if (stopped()) return;
    const Picture truth = render(p_.scene, config, accel);
    for (std::int64_t samples = 1; samples <= 64 && !stopped(); samples *= 2) {
      config.image.samples = samples;
      report::SamplingRow& row =
          out_.sampling.emplace_back(report::SamplingRow{static_cast<std::uint64_t>(samples), 0, 0});
      for (int seed = 0; seed < kSamplingSeeds; ++seed) {
        config.image.seed = small_.image.seed + seed;
        const double start = thread_cpu_seconds();
        const Picture picture = render(p_.scene, config, accel);
        row.seconds += (thread_cpu_seconds() - start) / kSamplingSeeds;
        row.rmse += noise(picture, truth) / kSamplingSeeds;
      }
    }
    out_.sampling_slope = report::log_log_slope(out_.sampling);
    done();
  }

  const Prepared& p_;
  const AccuracyArguments& arguments_;
  const InterruptScope& interrupt_;
  Config small_;
  LevelledAccel accel_;
  Config lifted_;  ///< the machine in which the testers limit
  accel::ExactReference exact_;
  std::optional<accel::ExactOpacity> exact_opacity_;  ///< if the scene is not all opaque
  std::vector<AccuracyConfig> levels_;
  RayBatch rays_;
  std::vector<RayBatch> pictures_;  ///< by seed: see make_pictures()
  std::vector<HardScene> hard_;
  std::deque<LevelledAccel> hard_accels_;  // one for each element of hard_, whose scenes they refer to
  std::vector<std::vector<accel::ExactHit>> hard_exact_;
  std::optional<report::ProgressLine> progress_;
  std::size_t step_ = 0, steps_ = 1;
  report::Accuracy out_;
};

}  // namespace

int accuracy_command(const AccuracyArguments& arguments) {
  const InterruptScope interrupt;
  std::filesystem::path folder = arguments.out;
  if (folder.empty())
    folder = std::filesystem::path("out") /
             (arguments.config.empty() ? "accuracy" : std::filesystem::path(arguments.config).stem());
  std::optional<OutputFolder> output;
  const auto open_output = [&](const Prepared& of) {
    const Config config = of.absolute_config();
    output.emplace(folder, &config, arguments.force, Results::kAccuracy);
  };
  const Prepared p = arguments.config.empty() ? prepare_config(kBuiltInConfig, "built-in", arguments.sets)
                                              : prepare(arguments, {}, false, open_output);
  if (!output) open_output(p);
  if (p.config().workload.kind != WorkloadConfig::Kind::kRays)
    throw ConfigError({{p.located.positions.find("workload"), "workload", "accuracy draws pictures; expected rays"}});
  if (p.accel.gaussians)
    throw ConfigError({{p.located.positions.find("scene"), "scene",
                        "exact arithmetic knows surfaces alone; expected a scene without Gaussians"}});
  if (!p.config().bvh.file.empty())
    throw ConfigError({{p.located.positions.find("bvh.file"), "bvh.file",
                        "accuracy builds the structure at each level of accuracy; expected a configuration without "
                        "trees of a file"}});
  const report::Accuracy accuracy = Trial(p, arguments, interrupt).run();
  const nlohmann::ordered_json result = report::accuracy_json(accuracy);
  const std::string json = report::sealed(result).dump(2) + "\n";
  const std::exception_ptr failure = output->write([&](const std::filesystem::path& staging) {
    write_file(staging / "config.resolved.yaml", resolved_yaml(p.absolute_config()));
    write_file(staging / "accuracy.html", report::html::accuracy_page(result));
    write_file(staging / "accuracy.json", json);
  });
  if (arguments.json)
    print_result(json);
  else if (!arguments.quiet)
    print_text((arguments.table ? report::accuracy_table(accuracy) : report::accuracy_summary(accuracy)) +
               (failure ? "files: none, they cannot be written\n"
                        : "files: " + folder.string() + "/accuracy.json, accuracy.html\n"));
  if (failure) std::rethrow_exception(failure);
  return accuracy.incomplete ? interrupt.status() : kDone;
}

}  // namespace carousel::app
