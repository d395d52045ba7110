#include "shading/surface/opacity_states.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scene/model/opacity.h"
#include "shading/surface/texture_lookup.h"

namespace carousel::shading {

namespace {

using scene::MicroGrid;
using scene::OpacityMicromaps;
using scene::OpacityState;

/// Points that are looked up in a micro-triangle lie within this of it, in u and v.
constexpr double kPointMargin = 0x1p-21;
/// Of 16 roundings to float one behind the other, which a lookup's alpha does not have: 7 of the texture's, 6 of the
/// vertices' and 2 of their products. Coordinates have up to 20, of terms that each are half of their size at most.
constexpr double kRounding = 0x1p-20, kCoordinateRounding = 0x1p-19;

/// A function that is linear on a triangle, by its values at the corners.
struct Linear {
  std::array<double, 3> at{};

  double operator()(double u, double v) const { return at[0] + (at[1] - at[0]) * u + (at[2] - at[0]) * v; }
  double slope() const { return std::abs(at[1] - at[0]) + std::abs(at[2] - at[0]); }
};

struct Range {
  double low, high;
};

using Corners = std::array<std::array<double, 2>, 3>;

/// The values that the function has in a micro-triangle and within the margin of it, and those beyond by `rounding`.
Range range_of(const Linear& f, const Corners& corners, double rounding) {
  Range out{INFINITY, -INFINITY};
  for (const auto& [u, v] : corners) {
    out.low = std::min(out.low, f(u, v));
    out.high = std::max(out.high, f(u, v));
  }
  const double more = kPointMargin * f.slope() + rounding;
  return {out.low - more, out.high + more};
}

/// Decides states of one triangle.
class TriangleStates {
 public:
  TriangleStates(const scene::Scene& scene, const scene::Mesh& mesh, std::uint32_t triangle)
      : material_(scene.materials[mesh.triangle_materials[triangle].value]) {
    const std::uint32_t* corner = mesh.indices.data() + 3 * std::size_t{triangle};
    for (std::size_t i = 0; i < 3; ++i)
      colour_.at[i] = mesh.colors.empty() ? 1.0 : static_cast<double>(mesh.colors[corner[i]].a);
    if (!material_.base_color_texture) return;
    const scene::TextureUse& use = *material_.base_color_texture;
    texture_ = &scene.textures[use.texture.value];
    image_ = &scene.images[texture_->image.value];
    const std::vector<Vec2>& uvs = use.uv_set == 0 ? mesh.uv0 : mesh.uv1;
    // The coordinates of a sum of products are as large as these sums of their absolute values, and so is the rounding.
    double greatest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 given = uvs.empty() ? Vec2{0, 0} : uvs[corner[i]];
      const Vec2 uv = transform_uv(use, given);
      x_.at[i] = static_cast<double>(uv.x) * image_->width;
      y_.at[i] = static_cast<double>(uv.y) * image_->height;
      greatest = std::max({greatest, std::abs(double{given.x} * use.scale.x), std::abs(double{given.y} * use.scale.y)});
    }
    const double size = 2 * greatest + std::max(std::abs(use.offset.x), std::abs(use.offset.y)) + 1;
    x_rounding_ = kCoordinateRounding * size * image_->width;
    y_rounding_ = kCoordinateRounding * size * image_->height;
  }

  OpacityState of(const Corners& corners) const {
    const Range colour = range_of(colour_, corners, 0);
    const double factor = material_.base_color.a;
    // A product of values that may be negative is not bounded by the product of the bounds.
    if (!(factor >= 0) || !(colour.high >= 0)) return OpacityState::kUnknown;
    const double low = factor * std::max(0.0, colour.low), high = factor * colour.high;
    if (image_ == nullptr || image_->width == 0 || image_->height == 0) return judge(low, high);
    return of_texels(corners, low, high);
  }

 private:
  /// For every alpha from `low` to `high`, before rounding, as AlphaTest judges it.
  OpacityState judge(double low, double high) const {
    low = std::min(1.0, low) * (1 - kRounding);
    high = std::min(1.0, high) * (1 + kRounding);
    const bool mask = material_.alpha_mode == scene::AlphaMode::kMask;
    const float solid = (mask ? material_.alpha_cutoff : 1.0f) - scene::kAlphaTolerance;
    if (low >= double{solid}) return OpacityState::kOpaque;
    if (mask ? high < double{solid} && solid > 0 : high <= 0) return OpacityState::kTransparent;
    return OpacityState::kUnknown;
  }

  /// `low` and `high` bound what the texture's alpha is multiplied with.
  OpacityState of_texels(const Corners& corners, double low, double high) const {
    // A filtered lookup blends the texels around a point, whose cells are shifted by half a texel.
    const bool blends = texture_->linear_filter;
    const double shift = blends ? 0.5 : 0.0;
    const Range x = range_of(x_, corners, x_rounding_), y = range_of(y_, corners, y_rounding_);
    const double x0 = std::floor(x.low - shift), x1 = std::floor(x.high - shift);
    const double y0 = std::floor(y.low - shift), y1 = std::floor(y.high - shift);
    if (!(std::max({-x0, x1, -y0, y1}) < kFarthest)) return OpacityState::kUnknown;  // or not finite
    if ((x1 - x0 + 1) * (y1 - y0 + 1) > kMostCells) return OpacityState::kUnknown;
    const Edges edges = edges_of(corners);
    int least = 255, most = 0;
    for (auto iy = static_cast<std::int64_t>(y0); iy <= static_cast<std::int64_t>(y1); ++iy)
      for (auto ix = static_cast<std::int64_t>(x0); ix <= static_cast<std::int64_t>(x1); ++ix) {
        if (edges.misses(double(ix) + shift, double(iy) + shift)) continue;
        for (int corner = 0; corner < (blends ? 4 : 1); ++corner) {
          const int alpha = texel(ix + (corner & 1), iy + (corner >> 1));
          least = std::min(least, alpha);
          most = std::max(most, alpha);
        }
        if (between(low, high, least, most) == OpacityState::kUnknown) return OpacityState::kUnknown;
      }
    return least > most ? OpacityState::kUnknown : between(low, high, least, most);
  }
  OpacityState between(double low, double high, int least, int most) const {
    return judge(low * (least / 255.0), high * (most / 255.0));
  }

  /// The sides of a micro-triangle, in texels, outward by what its points may be off.
  struct Edges {
    struct Side {
      double nx = 0, ny = 0, at = 0;
    };
    std::array<Side, 3> sides{};
    /// True if no point of the cell of one texel from (x, y) on lies within all sides.
    bool misses(double x, double y) const {
      return std::any_of(sides.begin(), sides.end(), [&](const Side& side) {
        return side.nx * (x + 0.5) + side.ny * (y + 0.5) + 0.5 * (std::abs(side.nx) + std::abs(side.ny)) < side.at;
      });
    }
  };
  Edges edges_of(const Corners& corners) const {
    Edges out;
    std::array<std::array<double, 2>, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = {x_(corners[i][0], corners[i][1]), y_(corners[i][0], corners[i][1])};
    const double off_x = kPointMargin * x_.slope() + x_rounding_, off_y = kPointMargin * y_.slope() + y_rounding_;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto &a = p[i], &b = p[(i + 1) % 3], &c = p[(i + 2) % 3];
      Edges::Side& side = out.sides[i];
      side = {a[1] - b[1], b[0] - a[0], 0};
      const double third = side.nx * (c[0] - a[0]) + side.ny * (c[1] - a[1]);
      if (third < 0) side = {-side.nx, -side.ny, 0};
      side.at = side.nx * a[0] + side.ny * a[1];
      side.at -= std::abs(side.nx) * off_x + std::abs(side.ny) * off_y;
    }
    return out;
  }

  int texel(std::int64_t x, std::int64_t y) const {
    const auto column = wrapped(x, image_->width, texture_->wrap_u), row = wrapped(y, image_->height, texture_->wrap_v);
    return image_->rgba[4 * (std::size_t{row} * image_->width + column) + 3];
  }

  static constexpr double kFarthest = 0x1p22;   // coordinates of float still have two bits of fraction there
  static constexpr double kMostCells = 0x1p22;  // more are not looked through

  const scene::Material& material_;
  const scene::Texture* texture_ = nullptr;
  const scene::Image* image_ = nullptr;
  Linear x_, y_, colour_;                   // texture coordinates in texels; alpha of the vertices
  double x_rounding_ = 0, y_rounding_ = 0;  // in texels
};

/// The corners of micro-triangle (u, v).
Corners corners_of(const MicroGrid& grid, std::uint32_t u, std::uint32_t v, bool upper) {
  const double step = 1.0 / grid.side(), x = u * step, y = v * step;
  if (upper) return {{{x + step, y}, {x + step, y + step}, {x, y + step}}};
  return {{{x, y}, {x + step, y}, {x, y + step}}};
}

void fill(const TriangleStates& triangle, const MicroGrid& grid, std::vector<std::uint8_t>& out) {
  for (std::uint32_t v = 0; v < grid.side(); ++v)
    for (std::uint32_t u = 0; u + v < grid.side(); ++u)
      for (const bool upper : {false, true})
        if (!upper || u + v + 1 < grid.side())
          out[grid.number(u, v, upper)] = static_cast<std::uint8_t>(triangle.of(corners_of(grid, u, v, upper)));
}

/// Adds one triangle's states and returns its entry.
std::uint32_t add(OpacityMicromaps& maps, const std::vector<std::uint8_t>& states, bool four_states) {
  std::array<std::uint64_t, 3> counts{};
  for (const std::uint8_t state : states) ++counts[state];
  const auto [transparent, opaque, unknown] = counts;
  if (opaque == states.size()) return ++maps.opaque, OpacityMicromaps::kAllOpaque;
  if (transparent == states.size()) return ++maps.transparent, OpacityMicromaps::kAllTransparent;
  if (unknown == states.size() || (unknown > 0 && !four_states)) return ++maps.unknown, OpacityMicromaps::kAllUnknown;
  const auto number = static_cast<std::uint32_t>(maps.maps());
  for (std::size_t i = 0; i < states.size(); i += 4)
    maps.states.push_back(
        static_cast<std::uint8_t>(states[i] | states[i + 1] << 2 | states[i + 2] << 4 | states[i + 3] << 6));
  maps.micro_opaque += opaque;
  maps.micro_transparent += transparent;
  maps.micro_unknown += unknown;
  return number;
}

}  // namespace

OpacityMicromaps make_micromaps(const scene::Scene& scene, int level, bool four_states) {
  OpacityMicromaps maps;
  maps.grid.level = level;
  maps.bits = four_states ? 2 : 1;
  for (const scene::Instance& instance : scene.instances) maps.mesh_of.push_back(instance.mesh.value);
  const scene::Opacity opacity(scene);
  std::vector<std::uint8_t> states(maps.grid.count());
  for (const scene::Mesh& mesh : scene.meshes) {
    maps.first_of.push_back(maps.entries.size());
    std::vector<std::uint32_t> entries(mesh.triangle_count(), OpacityMicromaps::kNoIndex);
    bool any = false;
    for (std::uint32_t t = 0; t < entries.size(); ++t) {
      if (!opacity.may_be_non_opaque(mesh, t)) continue;
      any = true;
      fill(TriangleStates(scene, mesh, t), maps.grid, states);
      entries[t] = add(maps, states, four_states);
    }
    if (any) maps.entries.insert(maps.entries.end(), entries.begin(), entries.end());
  }
  maps.first_of.push_back(maps.entries.size());
  return maps;
}

}  // namespace carousel::shading
