#pragma once

#include <cstdint>
#include <vector>

#include "shading/camera/pixel_order.h"

namespace carousel::shading {

/// Some of a frame's paths, in the frame's order or nearly.
class PathSample {
 public:
  /// Paths whose ordinals in the frame follow one another.
  struct Run {
    std::uint64_t first = 0, count = 0;
    std::uint32_t place = 0;  ///< equal for the runs of one place; ascending
  };
  explicit PathSample(const std::vector<Run>& runs);

  std::uint64_t count() const { return begins_.back(); }
  /// The ordinal in the frame of the sample's path `i`. Precondition: i < count().
  std::uint64_t ordinal(std::uint64_t i) const;
  const std::vector<Run>& runs() const { return runs_; }

 private:
  std::vector<Run> runs_;
  std::vector<std::uint64_t> begins_;  // by run: the sample's paths before it; the count of all at the end
};

/// About `paths` paths, drawn over the whole picture: it is cut into equal rectangles, and of each some tiles of a row
/// that are neighbours are drawn at random by `seed` and `draw`: 16 places, or more if each of them can have `together`
/// paths then. Neighbours bring the same shapes into the caches and fill the same collections, as in the frame; and the
/// more places there are, the more surely their mix is the frame's. A tile's first samples are taken, as many as leave
/// 128 tiles or more, or as make `together` paths of one tile, or all. The rectangles follow one another row by row, so
/// that the upper part of the picture comes before the lower, as in the frame.
PathSample draw_tiles(const PixelOrder& order, std::uint64_t paths, std::uint64_t together, std::uint64_t seed,
                      std::uint64_t draw = 0);

/// Draws about so many places, however many paths each of them then has, with the first `each` samples of a tile.
PathSample draw_places(const PixelOrder& order, std::uint64_t paths, std::uint64_t places, std::uint64_t each,
                       std::uint64_t seed, std::uint64_t draw = 0);

inline constexpr std::uint64_t kListRun = 64;
/// About `paths` elements of a list of `all`, drawn likewise: runs of kListRun, one of each of equal parts.
PathSample draw_list(std::uint64_t all, std::uint64_t paths, std::uint64_t seed, std::uint64_t draw = 0);

/// A sample and after it the last places of another one of the same frame, with so many paths or somewhat more, that
/// are not among its own.
PathSample followed_by(const PathSample& sample, const PathSample& others, std::uint64_t paths);

/// A process's share of a frame of `all` paths among `parts` processes: runs of neighbours in turn, so that each has
/// some of every part of the picture.
PathSample share_of_paths(std::uint64_t all, std::uint64_t part, std::uint64_t parts);

}  // namespace carousel::shading
