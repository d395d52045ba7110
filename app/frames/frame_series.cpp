#include "app/frames/frame_series.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "accel/builders/clusters.h"
#include "accel/builders/refit.h"
#include "app/build_report/experiment.h"
#include "app/frames/frame_builder.h"
#include "app/frames/wear.h"
#include "core/config/write.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "report/text/number_text.h"
#include "ringbus/cycle/builder/builder_work.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "scene/moment.h"

namespace carousel::app {

namespace {

class FrameSeries {
 public:
  FrameSeries(const ConfigArguments& arguments, Prepared& prepared, const InterruptScope& interrupt, bool quiet,
              const TakeFrame& take)
      : arguments_(arguments),
        p_(prepared),
        series_(*prepared.config().frames),
        interrupt_(interrupt),
        quiet_(quiet),
        take_(take) {
    cut();
  }

  report::Report run() {
    report::Report report;
    std::optional<report::Verify> verified;
    for (std::int64_t i = 0; i < series_.count && !report.incomplete; ++i) {
      report::Frame row = bring_to(series_.first + i);
      RenderJob job(p_);
      frame_.last = i + 1 == series_.count;
      report = run_rays(arguments_, p_, job, interrupt_, quiet_, nullptr, nullptr, {}, &frame_);
      report.incomplete |= !updated_;
      if (report.verify) add(verified, *report.verify);
      fill(row, report);
      count(row);
      take_(job, series_.first + i, frame_.last || report.incomplete);
    }
    report.verify = verified;
    if (report.frames = std::move(rows_); cycle()) sum_cycles(*report.frames);
    return report;
  }

 private:
  bool cycle() const { return p_.config().engine.kind == EngineKind::kCycle; }

  /// Brings scene and structure to the moment of a frame.
  report::Frame bring_to(std::int64_t number) {
    report::Frame row;
    row.frame = static_cast<std::uint64_t>(number);
    const float moment = scene::moment_of_frame(p_.config().scene, series_, number);
    row.time = shortest(moment);
    row.update = "built";
    if (number > series_.first) move_to(moment, row);
    row.surface_cost = accel::surface_cost(p_.accel);
    return row;
  }

  void move_to(float moment, report::Frame& row) {
    scene::Scene after = load_moment(p_, moment);
    const accel::SceneChange change = accel::change_of(p_.scene, after);
    if (series_.update == FrameUpdate::kNone && !change.none()) refuse_motion(change, after, row);
    row.update = "kept";
    std::vector<accel::ClusterWork> work;
    if (!change.none()) row.why = follow(after, change, work);
    p_.scene = std::move(after);
    if (change.none()) {  // the camera or a light may have moved
      renew_any_hit(p_);
      return;
    }
    const FrameUpdate update = row.why.empty() ? series_.update : FrameUpdate::kRebuild;
    const bool anew = update == FrameUpdate::kRebuild;
    row.update = enum_name(update);
    if (anew) {
      rebuild(p_);
      cut();
    } else {
      renew_any_hit(p_);
    }
    if (clusters_) row.clusters = clusters_of(work);
    rebuilt_.reset();
    if (!anew) rebuilt_ = rebuild_beside(p_, row);
    if (!cycle()) return;
    std::optional<DoneClusters> done;
    if (update == FrameUpdate::kClusters) done.emplace(*clusters_, work);
    const BuilderFrame builder = build_in_machine(p_, parts_of(p_.accel, change), update, done ? &*done : nullptr,
                                                  interrupt_.token(), frame_.cached);
    updated_ = builder.complete;
    row.builder = builder.cost;
    if (anew) return;
    const report::FrameUpdateCost other = rebuild_cost(p_, *rebuilt_, parts_of(*rebuilt_, change), interrupt_.token());
    row.rebuild_cycles = other.cycles;
    row.rebuild_bytes = other.bytes_read + other.bytes_written;
  }

  /// Cuts a structure that is new.
  void cut() {
    if (series_.update != FrameUpdate::kClusters) return;
    std::optional<std::uint32_t> most;
    if (series_.cluster_primitives) most = static_cast<std::uint32_t>(*series_.cluster_primitives);
    clusters_ = accel::cut_clusters(p_.accel, p_.scene, most, most_dealt());
  }

  /// Clusters of a mesh for which the builder's store has room.
  std::uint64_t most_dealt() const { return static_cast<std::uint64_t>(series_.builder.local_primitives); }

  /// Brings the structure to a scene that moves, unless that is done by a rebuild. Returns why it cannot be.
  std::string follow(const scene::Scene& after, const accel::SceneChange& change,
                     std::vector<accel::ClusterWork>& work) {
    const BvhConfig::Storage storage = p_.config().bvh.storage;
    const std::unique_ptr<Executor> executor = make_executor(p_.threads);
    if (series_.update == FrameUpdate::kRefit) return accel::refit(p_.accel, after, change, storage, *executor);
    if (series_.update != FrameUpdate::kClusters) return "";
    const int depth = p_.accel.max_depth;
    std::string why =
        accel::update_clusters(p_.accel, *clusters_, p_.scene, after, change, storage, most_dealt(), *executor, work);
    if (p_.accel.max_depth > depth) renew_room(p_);
    return why;
  }

  report::FrameClusters clusters_of(const std::vector<accel::ClusterWork>& work) const {
    report::FrameClusters out;
    out.count = clusters_->count();
    out.bytes = ringbus::cycle::cluster_bytes(p_.accel, *clusters_);
    for (const accel::ClusterWork& of_mesh : work) {
      out.rebuilt += of_mesh.moved.size();
      out.better += static_cast<std::uint64_t>(std::count(of_mesh.is_better.begin(), of_mesh.is_better.end(), true));
      out.dealt_meshes += std::ranges::any_of(of_mesh.dealt, &accel::DealtClusters::is_better);
    }
    return out;
  }

  /// What the builder has to do. A structure with flattened instances has moved as a whole.
  accel::ChangedParts parts_of(const accel::Accel& accel, const accel::SceneChange& change) const {
    return change.other.empty() && accel.baked_instances == 0 ? accel::changed_parts(accel, p_.scene, change)
                                                              : ringbus::cycle::all_parts(accel);
  }

  [[noreturn]] void refuse_motion(const accel::SceneChange& change, const scene::Scene& after,
                                  const report::Frame& row) const {
    std::string what = change.other;
    if (what.empty() && !change.meshes.empty())
      what = fmt::format("mesh {} ('{}') has another shape", change.meshes.front(),
                         after.meshes[change.meshes.front()].name);
    if (what.empty()) what = fmt::format("instance {} stands elsewhere", change.instances.front());
    throw ConfigError(
        {{p_.located.positions.find("frames.update"), "frames.update",
          fmt::format("in frame {}, at {} s, {}, and the structure stays as it was built; expected refit, "
                      "rebuild or clusters, found none",
                      row.frame, row.time, what)}});
  }

  static void add(std::optional<report::Verify>& sum, const report::Verify& one) {
    if (!sum) {
      sum = one;
      return;
    }
    sum->compared += one.compared;
    sum->mismatches += one.mismatches;
    if (sum->example.empty()) sum->example = one.example;
  }

  void fill(report::Frame& row, const report::Report& report) const {
    row.cycles = report.engine.cycles;
    if (report.raster_unit) row.raster_cycles = report.raster_unit->cycles;
    row.rays = report.rays.completed;
    if (report.tests) {
      row.box_tests = report.tests->counts.box;
      row.primitive_tests = report.tests->counts.triangle + report.tests->counts.procedural;
    }
    if (report.memory)
      row.memory_bytes = (report.memory->counts.lines + report.memory->counts.lines_written) *
                         ringbus::cycle::fetched_bytes(p_.config().memory);
    if (report.energy) row.joules = report.energy->joules;
    row.digest = report.digest;
    if (row.rebuild_cycles && !report.incomplete) judge_wear(p_, *rebuilt_, interrupt_.token(), row);
  }

  void count(report::Frame& row) {
    ++rows_.count;
    rows_.rays += row.rays;
    if (!quiet_)
      spdlog::info("frame {} at {} s: {}, {} rays{}", row.frame, row.time, row.update, report::grouped(row.rays),
                   row.cycles ? fmt::format(", {} cycles", report::grouped(*row.cycles)) : "");
    rows_.rows.push_back(std::move(row));
  }

  static void sum_cycles(report::Frames& frames) {
    frames.cycles = frames.builder_cycles = frames.builder_bytes = frames.limited_by_builder = frames.worn = 0;
    for (const report::Frame& row : frames.rows) {
      *frames.cycles += row.cycles.value_or(0) + row.raster_cycles.value_or(0);
      *frames.worn += row.rebuild_pays.value_or(false);
      if (!row.builder) continue;
      *frames.cycles += row.builder->cycles;
      *frames.builder_cycles += row.builder->cycles;
      *frames.builder_bytes += row.builder->bytes_read + row.builder->bytes_written;
      *frames.limited_by_builder += row.builder->cycles > row.cycles.value_or(0);
    }
  }

  const ConfigArguments& arguments_;
  Prepared& p_;
  const FramesConfig series_;
  const InterruptScope& interrupt_;
  bool quiet_;
  const TakeFrame& take_;
  SeriesFrame frame_;
  std::optional<accel::TreeClusters> clusters_;  // with frames.update: clusters
  std::optional<accel::Accel> rebuilt_;          // of a frame that is not built anew
  bool updated_ = true;                          // the builder's work of the frame was not interrupted
  report::Frames rows_;
};

}  // namespace

report::Report run_series(const ConfigArguments& arguments, Prepared& prepared, const InterruptScope& interrupt,
                          bool quiet, const TakeFrame& take) {
  return FrameSeries(arguments, prepared, interrupt, quiet, take).run();
}

}  // namespace carousel::app
