#include "shading/lights/sky_light.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/numeric/trigonometry.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/luminance.h"
#include "shading/math/spherical.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

namespace {

/// A choice among the items up to the last that has a weight. The last item of a choice may own a word without one.
LightChoice choice_of(std::span<const float> weights, unsigned bits) {
  while (!weights.empty() && !(weights.back() > 0.0f)) weights = weights.first(weights.size() - 1);
  return LightChoice(weights, bits);
}

/// The place within a chosen item, 0 to 1, of the word that chose it.
double place_in(const LightChoice& choice, std::uint32_t item, std::uint32_t word) {
  constexpr double kMiddle = 0x1p7;  // of the step between two words
  const auto [begin, end] = choice.words_of(item);
  return (static_cast<double>(word - begin) + kMiddle) / static_cast<double>(end - begin);
}

}  // namespace

SkyLight::SkyLight(const scene::SkyMap& map) : map_(map) {
  if (!is_lit(map)) return;
  for (std::uint32_t y = 0; y <= map.height; ++y) cosines_.push_back(cos_half_turns(double(y) / map.height));
  std::vector<float> rows, texels(map.width);
  columns_.reserve(map.height);
  for (std::uint32_t y = 0; y < map.height; ++y) {
    double sum = 0;
    for (std::uint32_t x = 0; x < map.width; ++x) {
      texels[x] = cell_luminance(x, y);
      sum += double{texels[x]};
    }
    columns_.push_back(choice_of(texels, kRandomBits));
    const double light = sum / map.width * (cosines_[y] - cosines_[y + 1]);
    rows.push_back(static_cast<float>(light));
    total_ += light * double{2.0f * kPi};
  }
  rows_ = choice_of(rows, kRandomBits);
}

/// The mean of the filtered luminance over a texel. Between centres of texels it changes linearly, so that a neighbour
/// has a share of 1/8 along each axis, and the texel itself 3/4.
float SkyLight::cell_luminance(std::uint32_t x, std::uint32_t y) const {
  const std::uint32_t left = x == 0 ? map_.width - 1 : x - 1, right = x + 1 == map_.width ? 0 : x + 1;
  const std::uint32_t above = y == 0 ? 0 : y - 1, below = y + 1 == map_.height ? y : y + 1;
  const auto row = [&](std::uint32_t v) {
    const Vec3* texels = &map_.texels[std::size_t{v} * map_.width];
    return 0.75f * luminance(texels[x]) + 0.125f * (luminance(texels[left]) + luminance(texels[right]));
  };
  return 0.75f * row(y) + 0.125f * (row(above) + row(below));
}

SkyLight::Place SkyLight::place_of(const Vec3& direction) const {
  const double x = direction.x, y = direction.y, z = direction.z;
  double around = angle_in_turns(x, -z) + 0.5 + double{map_.rotation};
  around -= std::floor(around);
  const double down = 2.0 * angle_in_turns(std::sqrt(x * x + z * z), y);
  return {around * map_.width, down * map_.height};
}

std::pair<std::uint32_t, std::uint32_t> SkyLight::texel_of(const Place& at) const {
  return {std::min(static_cast<std::uint32_t>(at.y), map_.height - 1),
          std::min(static_cast<std::uint32_t>(at.x), map_.width - 1)};
}

Vec3 SkyLight::filtered(const Place& at) const {
  const double x = at.x - 0.5, y = at.y - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const auto a = static_cast<float>(x - left), b = static_cast<float>(y - top);
  const std::int64_t width = map_.width, last = std::int64_t{map_.height} - 1;
  const auto column = [&](std::int64_t i) { return static_cast<std::size_t>((i + width) % width); };
  const auto row = [&](std::int64_t i) {
    return static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, last)) * map_.width;
  };
  const auto x0 = static_cast<std::int64_t>(left), y0 = static_cast<std::int64_t>(top);
  const std::size_t left_column = column(x0), right_column = column(x0 + 1), upper = row(y0), lower = row(y0 + 1);
  const std::vector<Vec3>& t = map_.texels;
  const Vec3 above = t[upper + left_column] * (1.0f - a) + t[upper + right_column] * a;
  const Vec3 below = t[lower + left_column] * (1.0f - a) + t[lower + right_column] * a;
  return above * (1.0f - b) + below * b;
}

float SkyLight::density(std::uint32_t row, std::uint32_t column) const {
  const double solid_angle = double{2.0f * kPi} / map_.width * (cosines_[row] - cosines_[row + 1]);
  return static_cast<float>(double{rows_.probability(row)} * double{columns_[row].probability(column)} / solid_angle);
}

SkyLight::Sample SkyLight::sample(const Vec2& u) const {
  const std::uint32_t row_word = word_of(u.y), row = rows_.choose(row_word);
  const std::uint32_t column_word = word_of(u.x), column = columns_[row].choose(column_word);
  // Within the texel's part of the sphere the cosine and the longitude are uniform.
  const double cosine = cosines_[row] + place_in(rows_, row, row_word) * (cosines_[row + 1] - cosines_[row]);
  const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
  const double around =
      (column + place_in(columns_[row], column, column_word)) / map_.width - 0.5 - double{map_.rotation};
  const SinCos longitude = sin_cos_turns(static_cast<float>(around));
  return {{static_cast<float>(sine * double{longitude.sin}), static_cast<float>(cosine),
           static_cast<float>(-sine * double{longitude.cos})},
          density(row, column)};
}

SkyLight::Seen SkyLight::look(const Vec3& direction) const {
  const Place at = place_of(direction);
  const auto [row, column] = texel_of(at);
  return {filtered(at), columns_[row].empty() ? 0.0f : density(row, column)};
}

}  // namespace carousel::shading
