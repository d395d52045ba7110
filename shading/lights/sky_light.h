#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/types/vec.h"
#include "core/types/workload.h"
#include "scene/model/sky_map.h"
#include "shading/lights/light_choice.h"

namespace carousel::shading {

/// An environment map as a light. Radiance is filtered between the centres of texels. Directions are chosen with a
/// density that is constant over each texel's part of the sphere, in proportion to the filtered luminance there: first
/// the row, then the texel in it (M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th edition,
/// section 12.5). Immutable; any thread. Keeps a reference to the map.
class SkyLight {
 public:
  explicit SkyLight(const scene::SkyMap& map);

  /// There is no map, or no light comes from it.
  bool empty() const { return rows_.empty(); }
  /// Luminance, integrated over the sphere.
  double irradiance() const { return total_; }

  struct Seen {
    Vec3 radiance{0};
    float pdf = 0;  ///< density per solid angle with which sample() finds the direction
  };
  /// What there is in a direction, of any length. Precondition: !empty().
  Seen look(const Vec3& direction) const;
  Vec3 radiance(const Vec3& direction) const { return filtered(place_of(direction)); }

  struct Sample {
    Vec3 direction{0};  ///< unit
    float pdf = 0;      ///< density per solid angle
  };
  /// Maps the unit square to directions. Precondition: !empty().
  Sample sample(const Vec2& u) const;

  // The reads of memory, appended to `out`. There stand the texels, 16 bytes each; behind them the thresholds of the
  // rows and those of the texels in each row, 4 bytes each. Precondition: !empty().

  /// Of look(): texels, and the thresholds that give the density.
  void append_reads(const Vec3& direction, std::vector<SkyRead>& out) const;
  /// Of sample() and of the radiance there: blocks of thresholds that the choice compares, then texels.
  void append_reads(const Vec2& u, std::vector<SkyRead>& out) const;

 private:
  static constexpr std::uint32_t kTexelBytes = 16, kThresholdBytes = 4;
  /// A place on the map, from its top left corner: 0 to below width, 0 to height.
  struct Place {
    double x = 0, y = 0;
  };
  Place place_of(const Vec3& direction) const;
  /// The row and the column.
  std::pair<std::uint32_t, std::uint32_t> texel_of(const Place& at) const;
  /// Random numbers are multiples of 2^-24 (core/numeric/rng.h), and so is each probability.
  static constexpr unsigned kRandomBits = 24;
  static std::uint32_t word_of(float u) { return static_cast<std::uint32_t>(double{u} * 0x1p32); }
  Vec3 filtered(const Place& at) const;
  void append_texels(const Place& at, std::vector<SkyRead>& out) const;
  std::uint64_t rows_at() const { return std::uint64_t{map_.width} * map_.height * kTexelBytes; }
  std::uint64_t columns_at(std::uint32_t row) const {
    return rows_at() + (map_.height + std::uint64_t{row} * map_.width) * kThresholdBytes;
  }
  float density(std::uint32_t row, std::uint32_t column) const;
  float cell_luminance(std::uint32_t x, std::uint32_t y) const;

  const scene::SkyMap& map_;
  double total_ = 0;
  std::vector<double> cosines_;       // of the polar angles between rows, height + 1 of them
  LightChoice rows_;                  // empty if there is no light
  std::vector<LightChoice> columns_;  // by row
};

}  // namespace carousel::shading
