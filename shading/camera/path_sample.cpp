#include "shading/camera/path_sample.h"

#include <algorithm>
#include <cmath>
#include <random>

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

PathSample::PathSample(const std::vector<Run>& runs) : begins_{0} {
  for (const Run& run : runs) {
    firsts_.push_back(run.first);
    begins_.push_back(begins_.back() + run.count);
  }
}

std::uint64_t PathSample::ordinal(std::uint64_t i) const {
  const auto run = std::upper_bound(begins_.begin(), begins_.end(), i) - begins_.begin() - 1;
  return firsts_[static_cast<std::size_t>(run)] + (i - begins_[static_cast<std::size_t>(run)]);
}

PathSample draw_tiles(const PixelOrder& order, std::uint64_t paths, std::uint64_t seed, std::uint64_t draw) {
  constexpr double kEnoughTiles = 128;
  const std::uint64_t columns = order.tile_columns(), rows = order.tile_rows(), samples = order.samples();
  const double pixels = PixelOrder::kTile * PixelOrder::kTile, wanted = static_cast<double>(paths) / pixels;
  const auto each = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(wanted / kEnoughTiles), 1, samples);
  const double tiles = std::max(1.0, wanted / static_cast<double>(each));
  // Rectangles of about the shape of a tile.
  const auto parts = [](double count, std::uint64_t most) {
    return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::lround(count)), 1, most);
  };
  const std::uint64_t down = parts(std::sqrt(tiles * static_cast<double>(rows) / static_cast<double>(columns)), rows);
  const std::uint64_t across = parts(tiles / static_cast<double>(down), columns);
  Uniform uniform(seed, draw);
  std::vector<PathSample::Run> runs;
  std::vector<bool> taken(columns * rows);
  for (std::uint64_t y = 0; y < down; ++y) {
    for (std::uint64_t x = 0; x < across; ++x) {
      std::uint64_t column = 0, row = 0;
      // A tile that lies in two rectangles may be drawn by both.
      for (int tries = 0; tries < 8; ++tries) {
        column = draw_within(columns, x, across, uniform);
        row = draw_within(rows, y, down, uniform);
        if (!taken[row * columns + column]) break;
      }
      if (taken[row * columns + column]) continue;
      taken[row * columns + column] = true;
      runs.push_back({order.tile_begin(column, row), each * order.tile_pixels(column, row)});
    }
  }
  return PathSample(runs);
}

PathSample draw_list(std::uint64_t all, std::uint64_t paths, std::uint64_t seed, std::uint64_t draw) {
  constexpr std::uint64_t kRun = 64;
  const std::uint64_t pieces = (all + kRun - 1) / kRun, parts = std::clamp<std::uint64_t>(paths / kRun, 1, pieces);
  Uniform uniform(seed, draw);
  std::vector<PathSample::Run> runs;
  std::uint64_t next = 0;  // the first piece that is not taken
  for (std::uint64_t part = 0; part < parts && next < pieces; ++part) {
    const std::uint64_t piece = std::max(next, draw_within(pieces, part, parts, uniform));
    runs.push_back({piece * kRun, std::min(kRun, all - piece * kRun)});
    next = piece + 1;
  }
  return PathSample(runs);
}

}  // namespace carousel::shading
