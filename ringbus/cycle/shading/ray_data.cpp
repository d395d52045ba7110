#include "ringbus/cycle/shading/ray_data.h"

#include <algorithm>
#include <array>
#include <utility>

#include "ringbus/cycle/shading/programs/data_lines.h"
#include "ringbus/cycle/shading/programs/data_places.h"

namespace carousel::ringbus::cycle {

namespace {

constexpr std::array<std::uint64_t RayDataBytes::*, kShadeData> kTableBytes{
    &RayDataBytes::materials_read, &RayDataBytes::vertices_read, &RayDataBytes::texels_read, &RayDataBytes::pages_read,
    &RayDataBytes::first_hits_read};
constexpr std::uint32_t kPixelBytes = 16;  // four floats
static_assert(kFilm + (std::uint64_t{1} << 32) * kPixelBytes < kSky);

MemoryConfig of_shared_cache(MemoryConfig memory) {
  memory.l1_kib = 0;
  return memory;
}

}  // namespace

RayData::RayData(const Settings& settings, const Workload& workload, const std::vector<SidePorts>& caches)
    : memory_(settings.memory),
      slots_(settings.slots),
      shared_by_(static_cast<std::uint32_t>(settings.memory.shared_by)),
      surfaces_(settings.surfaces),
      line_bytes_(static_cast<std::uint64_t>(settings.memory.line_bytes)),
      workload_(workload) {
  for (const SidePorts& cache : caches) ports_.emplace_back(of_shared_cache(memory_), settings.link, cache);
}

bool RayData::wanted(const MemoryConfig& memory, bool has_sky_map) {
  constexpr auto kInMemory = MemoryConfig::ShadingData::kMemory;
  return memory.ray_records == MemoryConfig::RayRecords::kMaster || memory.path_state == kInMemory ||
         memory.film == kInMemory || (has_sky_map && memory.sky_map == kInMemory);
}

// ---- places

ShapeSpan RayData::record_at(ResourceId resource, std::uint32_t slot) const {
  return {kRecords + (std::uint64_t{resource.value} * slots_ + slot) * sizeof(RayRecord), sizeof(RayRecord)};
}

/// States begin at borders of lines.
ShapeSpan RayData::state_at(std::uint32_t path, std::uint32_t bytes) const {
  return {kStates + path * (ceil_div(bytes, line_bytes_) * line_bytes_), bytes};
}

ShapeSpan RayData::pixel_at(std::uint32_t pixel) {
  return {kFilm + std::uint64_t{pixel} * kPixelBytes, kPixelBytes};
}

// ---- records

std::uint32_t RayData::begin() {
  if (free_.empty()) {
    waiting_.emplace_back();
    return static_cast<std::uint32_t>(waiting_.size() - 1);
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  return index;
}

void RayData::fetch(Group&& group, std::span<const Place> places, Cycle now) {
  const std::uint32_t index = begin();
  waiting_[index].kind = Kind::kRecord;
  waiting_[index].missing = places.size();
  waiting_[index].group = std::move(group);
  for (const auto& [resource, slot] : places) {
    const ShapeSpan span = record_at(resource, slot);
    port_of(resource).write(span, now);
    port_of(resource).request(span, index, now);
    bytes_.records_written += span.bytes;
    bytes_.records_read += span.bytes;
  }
}

void RayData::completed(ResourceId resource, std::span<const std::uint32_t> slots, Cycle now) {
  if (!keeps_records()) return;
  for (const std::uint32_t slot : slots) {
    port_of(resource).write(record_at(resource, slot), now);
    bytes_.records_written += sizeof(RayRecord);
  }
}

// ---- paths

bool RayData::fetch_for_shading(const RayResult& ray, Cycle now) {
  const std::uint32_t bytes = keeps_states() ? workload_.path_memory(ray.tag).state_bytes : 0;
  sky_reads_.clear();
  if (keeps_sky()) workload_.sky_reads(ray, sky_reads_);
  facts_ = surfaces_ ? workload_.shade_facts(ray) : ShadeFacts{};
  const std::size_t reads = sky_reads_.size() + (bytes > 0 ? 1 : 0);
  if (reads == 0 && facts_.material.empty()) return false;
  const std::uint32_t index = begin();
  waiting_[index].kind = Kind::kShading;
  waiting_[index].missing = reads;
  waiting_[index].ray = ray;
  if (bytes > 0) {
    const ShapeSpan span = state_at(ray.tag.path, bytes);
    port_of(span).request(span, index, now);
    bytes_.states_read += span.bytes;
  }
  for (const SkyRead& read : sky_reads_) {
    const ShapeSpan span{kSky + read.offset, read.bytes};
    port_of(span).request(span, index, now);
    bytes_.sky_read += span.bytes;
  }
  std::size_t& missing = waiting_[index].missing;
  missing += read_lines(ShadeData::kMaterial, std::move(facts_.material), index, now);
  missing += read_lines(ShadeData::kVertices, std::move(facts_.vertices), index, now);
  for (std::vector<DataRead>& lookup : facts_.lookups)
    missing += read_lines(ShadeData::kTexels, std::move(lookup), index, now);
  return true;
}

void RayData::read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) {
  const std::uint32_t index = begin();
  waiting_[index].kind = Kind::kProgram;
  waiting_[index].read = by;
  waiting_[index].missing = read_lines(what, {data}, index, now);
}

/// Reads data of a table; returns the number of reads, one a line.
std::size_t RayData::read_lines(ShadeData what, std::vector<DataRead> data, std::uint32_t index, Cycle now) {
  if (what != ShadeData::kPages) by_line(data, line_bytes_);
  for (const DataRead& read : data) {
    const ShapeSpan span{table_of(what) + read.offset, read.bytes};
    port_of(span).request(span, index, now);
    bytes_.*kTableBytes[static_cast<std::size_t>(what)] += span.bytes;
  }
  return data.size();
}

void RayData::made(std::span<const RayRequest> rays, Cycle now) {
  for (const RayRequest& ray : rays) {
    if (ray.tag.path >= in_flight_.size()) in_flight_.resize(ray.tag.path + std::size_t{1});
    ++in_flight_[ray.tag.path];
    const std::uint32_t bytes = keeps_states() ? workload_.path_memory(ray.tag).state_bytes : 0;
    if (bytes == 0) continue;
    const ShapeSpan span = state_at(ray.tag.path, bytes);
    port_of(span).write(span, now);
    bytes_.states_written += bytes;
  }
}

void RayData::will_shade(const HitBatch& rays) {
  pixels_.clear();
  for (const RayResult& ray : rays) pixels_.push_back(workload_.path_memory(ray.tag).pixel);
}

void RayData::shaded(const HitBatch& rays, Cycle now) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (--in_flight_[rays[i].tag.path] > 0 || memory_.film != MemoryConfig::ShadingData::kMemory || !pixels_[i])
      continue;
    const std::uint32_t index = begin();
    waiting_[index].kind = Kind::kFilm;
    waiting_[index].missing = 1;
    waiting_[index].pixel = *pixels_[i];
    const ShapeSpan span = pixel_at(*pixels_[i]);
    port_of(span).request(span, index, now);
    bytes_.film_read += span.bytes;
  }
}

// ---- answers

Cycle RayData::next() const {
  Cycle first = kNever;
  for (const ShapePort& port : ports_) first = std::min(first, port.next());
  return first;
}

void RayData::take(Cycle now, Arrived& arrived) {
  arrived.rays.clear();
  arrived.groups.clear();
  arrived.reads.clear();
  for (ShapePort& port : ports_) {
    while (port.next() <= now) {
      const std::uint32_t index = port.take();
      Waiting& waiting = waiting_[index];
      if (--waiting.missing > 0) continue;
      free_.push_back(index);
      if (waiting.kind == Kind::kRecord) {
        arrived.groups.push_back(std::move(waiting.group));
        waiting.group = {};
      } else if (waiting.kind == Kind::kShading) {
        arrived.rays.push_back(waiting.ray);
      } else if (waiting.kind == Kind::kProgram) {
        arrived.reads.push_back(waiting.read);
      } else {
        const ShapeSpan span = pixel_at(waiting.pixel);
        port.write(span, now);
        bytes_.film_written += span.bytes;
      }
    }
  }
}

std::uint64_t RayData::lines() const {
  std::uint64_t lines = 0;
  for (const ShapePort& port : ports_) lines += port.lines();
  return lines;
}

}  // namespace carousel::ringbus::cycle
