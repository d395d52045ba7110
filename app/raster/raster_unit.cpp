#include "app/raster/raster_unit.h"

#include <algorithm>
#include <vector>

#include "app/area/machine_area.h"
#include "app/energy/unit_energy.h"
#include "core/config/costs.h"
#include "ringbus/cycle/builder/builder_unit.h"
#include "ringbus/cycle/builder/builder_work.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/shading/programs/data_places.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "shading/camera/pixel_order.h"
#include "shading/raster/first_hits.h"
#include "shading/tracer/shade_tables.h"

namespace carousel::app {

namespace {

using ringbus::cycle::BuilderTask;
using ringbus::cycle::BuilderWork;
using ringbus::cycle::ShapeMemory;
using ringbus::cycle::ShapeSpan;
using shading::FirstHits;

constexpr std::uint32_t kChunk = 64;     // triangles of a task that sets up
constexpr std::uint32_t kListBytes = 8;  // instance and primitive

/// The tasks of a pass. A task of the builder's unit counts "boxes", which are cycles here.
class PassWork {
 public:
  PassWork(const Prepared& p, const FirstHits& hits)
      : p_(p),
        hits_(hits),
        raster_(p.config().raster),
        tables_(p.scene),
        memory_(p.accel, p.config().accuracy, p.config().bvh, p.config().memory) {}

  BuilderWork take() {
    work_.levels.resize(2);
    set_up();
    sort();
    const auto width = static_cast<std::uint32_t>(p_.config().image.width),
               height = static_cast<std::uint32_t>(p_.config().image.height);
    const shading::PixelOrder order(width, height, hits_.samples);
    std::uint64_t list = ringbus::cycle::kTileLists;
    for (std::uint64_t tile = 0; tile < hits_.tiles.size(); ++tile)
      draw(hits_.tiles[tile], order, tile % order.tile_columns(), tile / order.tile_columns(), list);
    return std::move(work_);
  }

 private:
  static std::uint64_t over(std::uint64_t count, std::int64_t rate) {
    return ringbus::ceil_div(count, static_cast<std::uint64_t>(rate));
  }

  /// The time of any-hit calls: on the units of a resource, or on shader workers, which have nothing else to do then.
  std::uint64_t any_hit_cycles(std::uint64_t calls) const {
    const Config& c = p_.config();
    if (c.testers.any_hit == TestersConfig::AnyHit::kInline) {
      const TesterUnits& units = c.testers.units[UnitKind::kAnyHit];
      return over(calls * static_cast<std::uint64_t>(units.interval_cycles), units.units);
    }
    if (c.shading.program.any_hit()) return 0;
    return over(over(calls, c.shading.lanes) * static_cast<std::uint64_t>(c.shading.cycles_per_any_hit),
                shader_workers(c));
  }

  void read_vertices(FirstHits::Triangle of, BuilderTask& task) const {
    const std::uint32_t mesh = p_.scene.instances[of.instance].mesh.value;
    for (std::size_t k = 0; k < 3; ++k) {
      const DataRead vertex = tables_.vertex(mesh, p_.scene.meshes[mesh].indices[3 * std::size_t{of.primitive} + k]);
      task.reads.push_back({ringbus::cycle::table_of(ShadeData::kVertices) + vertex.offset, vertex.bytes});
    }
    if (const ShapeSpan transform = memory_.transform(of.instance); transform.bytes > 0)
      task.reads.push_back(transform);
  }

  /// The reads of all chunks. Until sort(), `boxes` counts triangles.
  void set_up() {
    for (std::uint32_t i = 0; i < p_.scene.instances.size(); ++i) {
      first_.push_back(triangles_);
      const auto count = static_cast<std::uint32_t>(p_.scene.meshes[p_.scene.instances[i].mesh.value].triangle_count());
      for (std::uint32_t primitive = 0; primitive < count; ++primitive, ++triangles_) {
        if (triangles_ % kChunk == 0) work_.levels[0].emplace_back();
        read_vertices({i, primitive}, work_.levels[0].back());
        ++work_.levels[0].back().boxes;
      }
    }
  }

  /// The lists that the chunks write, one tile's behind another's.
  void sort() {
    std::uint64_t at = ringbus::cycle::kTileLists;
    for (const FirstHits::Tile& tile : hits_.tiles)
      for (const FirstHits::Triangle triangle : tile.triangles) {
        BuilderTask& chunk = work_.levels[0][(first_[triangle.instance] + triangle.primitive) / kChunk];
        chunk.writes.push_back({at, kListBytes});
        at += kListBytes;
      }
    for (BuilderTask& chunk : work_.levels[0])
      chunk.boxes =
          std::max(over(chunk.boxes, raster_.triangles_per_cycle), over(chunk.writes.size(), raster_.tiles_per_cycle));
  }

  void draw(const FirstHits::Tile& tile, const shading::PixelOrder& order, std::uint64_t column, std::uint64_t row,
            std::uint64_t& list) {
    BuilderTask& task = work_.levels[1].emplace_back();
    if (!tile.triangles.empty()) {
      const auto bytes = static_cast<std::uint32_t>(tile.triangles.size() * kListBytes);
      task.reads.push_back({list, bytes});
      list += bytes;
    }
    for (const FirstHits::Triangle triangle : tile.triangles) read_vertices(triangle, task);
    const std::uint64_t samples = order.tile_pixels(column, row) * order.samples();
    task.writes.push_back(
        {ringbus::cycle::table_of(ShadeData::kFirstHits) + order.tile_begin(column, row) * FirstHits::kSampleBytes,
         static_cast<std::uint32_t>(samples * FirstHits::kSampleBytes)});
    task.boxes = std::max({over(tile.triangles.size(), raster_.triangles_per_cycle),
                           over(tile.tested, raster_.samples_per_cycle), any_hit_cycles(tile.asked)});
  }

  const Prepared& p_;
  const FirstHits& hits_;
  const RasterConfig& raster_;
  const shading::ShadeTables tables_;
  const ShapeMemory memory_;
  std::vector<std::uint64_t> first_;  // by instance: the number of its first triangle
  std::uint64_t triangles_ = 0;
  BuilderWork work_;
};

/// A sample against three edges takes about as many products and comparisons as a box.
double tests_pj(const Config& c, const FirstHits::Counts& counts) {
  const Costs costs = costs_of(c);
  const auto set_up = static_cast<double>(counts.triangles + counts.binned),
             tested = static_cast<double>(counts.tested);
  double pj = set_up * costs.of(energy_of(UnitKind::kTriangle)) + tested * costs.of(energy_of(UnitKind::kBox));
  if (c.testers.any_hit == TestersConfig::AnyHit::kInline)
    pj += static_cast<double>(counts.any_hit_calls) * costs.of(energy_of(UnitKind::kAnyHit));
  return pj;
}

BuilderConfig unit_of(const RasterConfig& raster) {
  BuilderConfig out;
  out.bytes_per_cycle = raster.bytes_per_cycle;
  out.boxes_per_cycle = 1;
  out.latency_cycles = raster.latency_cycles;
  out.requests = raster.requests;
  out.asks = BuilderConfig::Asks::kL2;
  return out;
}

}  // namespace

std::optional<RasterPass> rasterise_in_machine(const Prepared& p, const RenderJob& job, const std::stop_token& stop,
                                               ringbus::cycle::CacheLines& cached) {
  const Config& c = p.config();
  const FirstHits* hits = job.first_hits();
  if (hits == nullptr || hits->tiles.empty()) return std::nullopt;
  const BuilderWork work = PassWork(p, *hits).take();
  if (cached.empty()) cached.emplace_back();
  const ringbus::cycle::BuilderUse use =
      ringbus::cycle::run_builder(unit_of(c.raster), c.memory, c.engine.clock_mhz, work, stop, cached.front());
  const std::uint64_t line_bytes = ringbus::cycle::fetched_bytes(c.memory);
  RasterPass out;
  out.complete = use.complete;
  report::RasterUnit& cost = out.cost;
  cost.cycles = use.cycles;
  cost.busy = use.boxes;
  cost.list_bytes = 2 * kListBytes * hits->counts.binned;
  cost.sample_bytes = std::uint64_t{FirstHits::kSampleBytes} * hits->hits.size();
  cost.bytes_read = use.memory.lines * line_bytes;
  cost.bytes_written = use.memory.lines_written * line_bytes;
  cost.l2 = {use.lines_read, use.l2->hits, use.lines_written, use.l2->write_fetches, use.l2->drained};
  if (c.energy.profile != CostProfile::kNone)
    cost.joules = unit_joules(costs_of(c), c.memory, use, raster_kib(c), 0, tests_pj(c, hits->counts));
  return out;
}

}  // namespace carousel::app
