#include "shading/camera/path_sample.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace carousel::shading {

namespace {

/// Numbers in [0, 1), the same on every platform.
class Uniform {
 public:
  Uniform(std::uint64_t seed, std::uint64_t draw) : random_(seed * 0x9e3779b97f4a7c15u + draw) {}
  double operator()() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 random_;
};

/// A random one of `all` places, within part `part` of `parts` equal ones, each as likely as any other in the whole.
std::uint64_t draw_within(std::uint64_t all, std::uint64_t part, std::uint64_t parts, Uniform& uniform) {
  const double at = (static_cast<double>(part) + uniform()) * static_cast<double>(all) / static_cast<double>(parts);
  return std::min(all - 1, static_cast<std::uint64_t>(at));
}

}  // namespace

PathSample::PathSample(const std::vector<Run>& runs) : runs_(runs), begins_{0} {
  for (const Run& run : runs) begins_.push_back(begins_.back() + run.count);
}

std::uint64_t PathSample::ordinal(std::uint64_t i) const {
  const auto run = std::upper_bound(begins_.begin(), begins_.end(), i) - begins_.begin() - 1;
  return runs_[static_cast<std::size_t>(run)].first + (i - begins_[static_cast<std::size_t>(run)]);
}

PathSample draw_tiles(const PixelOrder& order, std::uint64_t paths, std::uint64_t together, std::uint64_t seed,
                      std::uint64_t draw) {
  constexpr std::uint64_t kEnoughTiles = 128, kLeastPlaces = 16, kPixels = PixelOrder::kTile * PixelOrder::kTile;
  const std::uint64_t places = std::max(kLeastPlaces, paths / std::max<std::uint64_t>(1, together));
  const std::uint64_t each =
      std::clamp<std::uint64_t>(std::max(paths / kPixels / kEnoughTiles, together / kPixels), 1, order.samples());
  return draw_places(order, paths, places, each, seed, draw);
}

PathSample draw_places(const PixelOrder& order, std::uint64_t paths, std::uint64_t places, std::uint64_t each,
                       std::uint64_t seed, std::uint64_t draw) {
  const auto parts = [](double count, std::uint64_t most) {
    return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::lround(count)), 1, most);
  };
  const std::uint64_t pixels = PixelOrder::kTile * PixelOrder::kTile, rows = order.tile_rows();
  const std::uint64_t tiles = std::max<std::uint64_t>(1, paths / pixels / each);
  const std::uint64_t in_a_row = order.tile_columns();
  // A row is cut into places of nearly equal numbers of tiles, which stay together.
  const std::uint64_t columns = in_a_row / std::clamp<std::uint64_t>(tiles / places, 1, in_a_row);
  const double wanted = static_cast<double>(tiles * columns) / static_cast<double>(in_a_row);
  // Rectangles of about the shape of a square.
  const double wide = static_cast<double>(in_a_row) / static_cast<double>(rows);
  const std::uint64_t across = parts(std::sqrt(wanted * wide), columns);
  const std::uint64_t down = parts(wanted / static_cast<double>(across), rows);
  Uniform uniform(seed, draw);
  std::vector<PathSample::Run> runs;
  std::vector<bool> taken(columns * rows);
  std::uint32_t place = 0;
  for (std::uint64_t y = 0; y < down; ++y) {
    for (std::uint64_t x = 0; x < across; ++x) {
      std::uint64_t column = 0, row = 0;
      // A place that lies in two rectangles may be drawn by both.
      for (int tries = 0; tries < 8; ++tries) {
        column = draw_within(columns, x, across, uniform);
        row = draw_within(rows, y, down, uniform);
        if (!taken[row * columns + column]) break;
      }
      if (taken[row * columns + column]) continue;
      taken[row * columns + column] = true;
      for (std::uint64_t tile = column * in_a_row / columns; tile < (column + 1) * in_a_row / columns; ++tile)
        runs.push_back({order.tile_begin(tile, row), each * order.tile_pixels(tile, row), place});
      ++place;
    }
  }
  return PathSample(runs);
}

PathSample draw_list(std::uint64_t all, std::uint64_t paths, std::uint64_t seed, std::uint64_t draw) {
  const std::uint64_t pieces = (all + kListRun - 1) / kListRun,
                      parts = std::clamp<std::uint64_t>(paths / kListRun, 1, pieces);
  Uniform uniform(seed, draw);
  std::vector<PathSample::Run> runs;
  std::uint64_t next = 0;  // the first piece that is not taken
  for (std::uint64_t part = 0; part < parts && next < pieces; ++part) {
    const std::uint64_t piece = std::max(next, draw_within(pieces, part, parts, uniform));
    runs.push_back({piece * kListRun, std::min(kListRun, all - piece * kListRun), static_cast<std::uint32_t>(part)});
    next = piece + 1;
  }
  return PathSample(runs);
}

PathSample followed_by(const PathSample& sample, const PathSample& others, std::uint64_t paths) {
  std::vector<PathSample::Run> runs = sample.runs();
  std::set<std::uint64_t> taken;
  for (const PathSample::Run& run : runs) taken.insert(run.first);
  std::vector<PathSample::Run> last;
  std::uint64_t count = 0;
  for (auto run = others.runs().rbegin(); run != others.runs().rend() && count < paths; ++run)
    if (taken.count(run->first) == 0) {
      last.push_back(*run);
      count += run->count;
    }
  const std::uint32_t places = runs.empty() ? 0 : runs.back().place + 1;
  for (auto run = last.rbegin(); run != last.rend(); ++run)
    runs.push_back({run->first, run->count, places + run->place});
  return PathSample(runs);
}

PathSample share_of_paths(std::uint64_t all, std::uint64_t part, std::uint64_t parts) {
  constexpr std::uint64_t kMost = 1024, kTurns = 8;
  const std::uint64_t each = std::clamp<std::uint64_t>(all / (parts * kTurns), 1, kMost);
  std::vector<PathSample::Run> runs;
  for (std::uint64_t first = part * each; first < all; first += parts * each)
    runs.push_back({first, std::min(each, all - first), static_cast<std::uint32_t>(runs.size())});
  return PathSample(runs);
}

}  // namespace carousel::shading
