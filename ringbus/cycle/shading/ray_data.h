#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/config/fields/topology.h"
#include "core/statistics/ray_bytes.h"
#include "core/types/workload.h"
#include "ringbus/cycle/shading/programs/program_memory.h"
#include "ringbus/cycle/shapes/shape_port.h"
#include "ringbus/protocol/machine.h"

namespace carousel::ringbus::cycle {

/// The data of rays and paths that the configuration keeps in memory, and the wires on which ray control and shading
/// reach it: one pair to each L2, behind those of its resources.
///
/// - `memory.ray_records: master`: the record of a ray that gets a slot is written to its place in memory, and read
///   from there before it is loaded into the slot; when the ray is complete, it is written back.
/// - `memory.path_state: memory`: the state of a path is written for each ray that is made for it, and read when one
///   has come back, before that joins the queue of a worker.
/// - `memory.sky_map: memory`: what shading a ray reads of the map of the sky is read when the ray has come back,
///   before it joins the queue of a worker.
/// - `memory.surfaces: memory`: likewise what it reads of the surface, without programs.
/// - `memory.film: memory`: when the last ray of a path has been shaded, its pixel is read, and written when it has
///   come.
///
/// Nothing waits for a write. A place in memory is reached by one L2 only, so that the caches need no protocol: a
/// record by that of its resource, others by turns.
/// - what programs of shader workers read (`shading.program`) is read while they run.
class RayData final : public ProgramMemory {
 public:
  struct Settings {
    MemoryConfig memory;
    LinkConfig link;
    std::uint32_t slots = 1;  ///< slots of a resource, those of bundles included
    bool surfaces = false;    ///< memory.surfaces: memory, and no programs, which read themselves
  };
  /// A group that has slots, and waits for its records.
  struct Group {
    std::uint32_t issuer = 0;
    RayGroup rays;
  };

  /// `caches`: the channels to each L2 and back. Keeps a reference to the workload.
  RayData(const Settings& settings, const Workload& workload, const std::vector<SidePorts>& caches);
  /// Tells whether the configuration keeps such data, but for surfaces, in memory. A sky without a map has none.
  static bool wanted(const MemoryConfig& memory, bool has_sky_map);

  bool keeps_records() const { return memory_.ray_records == MemoryConfig::RayRecords::kMaster; }
  bool keeps_states() const { return memory_.path_state == MemoryConfig::ShadingData::kMemory; }
  bool keeps_sky() const { return memory_.sky_map == MemoryConfig::ShadingData::kMemory; }

  /// The resource and the slot of a record.
  using Place = std::pair<ResourceId, std::uint32_t>;
  /// A group has got slots, at `places`: writes its records and reads them. It comes back by take().
  void fetch(Group&& group, std::span<const Place> places, Cycle now);
  /// Rays that were in these slots are complete.
  void completed(ResourceId resource, std::span<const std::uint32_t> slots, Cycle now);
  /// Reads what shading a complete ray needs: the state of its path, parts of the sky, and the surface. The ray
  /// comes back by take(). Returns false if it need not wait.
  bool fetch_for_shading(const RayResult& ray, Cycle now);
  /// New rays have been made.
  void made(std::span<const RayRequest> rays, Cycle now);
  /// To be called before the workload shades rays, after which it may forget their paths.
  void will_shade(const HitBatch& rays);
  /// These rays have been shaded, and the rays that they cause are made.
  void shaded(const HitBatch& rays, Cycle now);

  std::uint64_t line_bytes() const override { return line_bytes_; }
  void read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) override;

  /// The time of the next answer.
  Cycle next() const;
  /// What has come.
  struct Arrived {
    HitBatch rays;                   ///< to be shaded
    std::vector<Group> groups;       ///< their records
    std::vector<ProgramRead> reads;  ///< of programs
  };
  /// Takes the answers, in place of what `arrived` had.
  void take(Cycle now, Arrived& arrived);

  const RayDataBytes& bytes() const { return bytes_; }
  std::uint64_t lines() const;  ///< asked for

 private:
  enum class Kind : std::uint32_t { kRecord, kShading, kFilm, kProgram };
  struct Waiting {
    Kind kind = Kind::kRecord;
    std::size_t missing = 0;  // reads
    Group group;              // kRecord
    RayResult ray;            // kShading
    std::uint32_t pixel = 0;  // kFilm
    ProgramRead read;         // kProgram
  };

  std::uint32_t begin();
  std::size_t read_lines(ShadeData what, std::vector<DataRead> data, std::uint32_t index, Cycle now);
  ShapeSpan record_at(ResourceId resource, std::uint32_t slot) const;
  ShapeSpan state_at(std::uint32_t path, std::uint32_t bytes) const;
  static ShapeSpan pixel_at(std::uint32_t pixel);
  ShapePort& port_of(ResourceId resource) { return ports_[resource.value / shared_by_]; }
  ShapePort& port_of(const ShapeSpan& span) { return ports_[span.address / line_bytes_ % ports_.size()]; }

  MemoryConfig memory_;
  std::uint32_t slots_, shared_by_;
  bool surfaces_;
  std::uint64_t line_bytes_;
  const Workload& workload_;
  std::vector<ShapePort> ports_;
  std::vector<Waiting> waiting_;
  std::vector<std::uint32_t> free_;                   // unused places in waiting_
  std::vector<std::uint32_t> in_flight_;              // by path: rays that have not been shaded
  std::vector<std::optional<std::uint32_t>> pixels_;  // pixels of the rays that are being shaded
  std::vector<SkyRead> sky_reads_;                    // scratch
  ShadeFacts facts_;                                  // scratch
  RayDataBytes bytes_;
};

}  // namespace carousel::ringbus::cycle
