#include "accel/builders/binary/sah_build.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>

namespace carousel::accel {

namespace {

constexpr int kBins = 16;
constexpr std::size_t kParallelNode = 1 << 15;  // below this a node is one task
constexpr std::size_t kBinningChunk = 1 << 15;

// x, y, z in one register. The fourth lane carries bits of an index and is never read as a number.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

Float4 load4(const BuildPrimitive& p, int offset) {
  Float4 out;
  std::memcpy(&out, reinterpret_cast<const char*>(&p) + offset, sizeof(out));
  return out;
}
Float4 low(const BuildPrimitive& p) {
  return load4(p, 0);
}
Float4 high(const BuildPrimitive& p) {
  return load4(p, 16);
}
/// Primitives are read one after another, and faster than processors fetch ahead by themselves.
void prefetch_after(const BuildPrimitive& p) {
  __builtin_prefetch(&p + 64);
}
Float4 min4(Float4 a, Float4 b) {
  return a < b ? a : b;
}
Float4 max4(Float4 a, Float4 b) {
  return a > b ? a : b;
}
Float4 splat(float x) {
  return Float4{x, x, x, x};
}
float half_area(Float4 lo, Float4 hi) {
  const Float4 e = hi - lo;
  return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

struct Box4 {
  Float4 lo = splat(std::numeric_limits<float>::infinity());
  Float4 hi = splat(-std::numeric_limits<float>::infinity());
  void extend(Float4 l, Float4 h) {
    lo = min4(lo, l);
    hi = max4(hi, h);
  }
  void extend(const Box4& b) { extend(b.lo, b.hi); }
  Aabb aabb() const { return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}; }
};

struct Bounds {
  Box4 box, centroids;  // centroids are doubled: lo + hi
  void extend(const BuildPrimitive& p) {
    const Float4 lo = low(p), hi = high(p), c = lo + hi;
    box.extend(lo, hi);
    centroids.extend(c, c);
  }
  void extend(const Bounds& b) {
    box.extend(b.box);
    centroids.extend(b.centroids);
  }
};

/// Maps a doubled centroid to its bins.
struct Binning {
  Float4 origin, scale;
  explicit Binning(const Box4& centroids) : origin(centroids.lo) {
    const Float4 extent = centroids.hi - centroids.lo;
    for (int a = 0; a < 3; ++a) {
      // 0.99: the largest centroid still falls into the last bin after rounding.
      const float s = extent[a] > 0 ? kBins * 0.99f / extent[a] : 0.0f;
      scale[a] = s < std::numeric_limits<float>::infinity() ? s : 0.0f;
    }
    scale[3] = 0;
    // bins() must subtract nothing from the bits of an index: as floats, two indices of 8 million and more may differ
    // by a denormal number, for which some processors take many times as long (docs/internals/performance.md).
    origin[3] = 0;
  }
  /// On one axis, as bins() says: faster where no other is wanted.
  int bin(Float4 centroid, int axis) const {
    const float b = (centroid[axis] - origin[axis]) * scale[axis];
    return b > 0 ? (b < kBins ? static_cast<int>(b) : kBins - 1) : 0;
  }
  /// On all axes at once. NaN, of sums that overflowed, goes to bin 0.
  Int4 bins(Float4 centroid) const {
    // Without the bits of an index, which are a denormal number and would take the product longer.
    const Float4 xyz = reinterpret_cast<Float4>(reinterpret_cast<Int4>(centroid - origin) & Int4{-1, -1, -1, 0});
    const Float4 b = max4(xyz * scale, Float4{});
    return __builtin_convertvector(min4(b, splat(kBins - 1)), Int4);
  }
};

struct Bins {
  std::array<std::array<Box4, kBins>, 3> box;
  std::array<std::array<std::uint32_t, kBins>, 3> count{};

  void add(std::span<const BuildPrimitive> primitives, const Binning& binning) {
    // Neighbours often fall into the same bin, and each would wait for the box that the one before has just written:
    // every other one has bins of its own, where they are many enough for these to be worth it.
    constexpr std::size_t kMany = 512;
    std::size_t next = 0;
    if (primitives.size() >= kMany) {
      Bins other;
      for (; next + 1 < primitives.size(); next += 2) {
        add(primitives[next], binning);
        other.add(primitives[next + 1], binning);
      }
      add(other);
    }
    for (; next < primitives.size(); ++next) add(primitives[next], binning);
  }
  void add(const Bins& other) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < kBins; ++b) {
        box[a][b].extend(other.box[a][b]);
        count[a][b] += other.count[a][b];
      }
  }

 private:
  void add(const BuildPrimitive& p, const Binning& binning) {
    prefetch_after(p);
    const Float4 lo = low(p), hi = high(p);
    const Int4 bins = binning.bins(lo + hi);
    for (int a = 0; a < 3; ++a) {
      const auto b = static_cast<std::size_t>(bins[a]);
      box[a][b].extend(lo, hi);
      ++count[a][b];
    }
  }
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();  // sum of half area times blocks
  int axis = -1;
  int bin = 0;  // left holds bins below this one
};

class Builder {
 public:
  Builder(BuildPrimitives& primitives, const SahSettings& settings, Executor& executor)
      : primitives_(primitives), settings_(settings), executor_(executor), nodes_(2 * primitives.size() - 1) {}

  BinaryTree run() {
    std::size_t free = 1;
    build(0, 0, primitives_.size(), bounds_of(0, primitives_.size()), 0, free);
    return std::move(nodes_);
  }

 private:
  float blocks(std::uint32_t n) const {
    const std::uint32_t most = n + settings_.block_primitives - 1;
    return static_cast<float>(settings_.block_primitives == 4 ? most / 4 : most / settings_.block_primitives);
  }

  std::span<const BuildPrimitive> range(std::size_t begin, std::size_t end) const {
    return {primitives_.data() + begin, end - begin};
  }

  Bounds bounds_of(std::size_t begin, std::size_t end) {
    return reduce<Bounds>(begin, end, [this](Bounds& out, std::size_t b, std::size_t e) {
      for (const BuildPrimitive& p : range(b, e)) {
        prefetch_after(p);
        out.extend(p);
      }
    });
  }

  Bins bins_of(std::size_t begin, std::size_t end, const Binning& binning) {
    return reduce<Bins>(begin, end, [&](Bins& out, std::size_t b, std::size_t e) { out.add(range(b, e), binning); });
  }

  // Minima, maxima and integer sums are exact, so the chunks' order cannot show.
  template <class T, class Body>
  T reduce(std::size_t begin, std::size_t end, const Body& body) {
    T total{};
    const std::size_t chunks = (end - begin + kBinningChunk - 1) / kBinningChunk;
    if (chunks < 4 || executor_.threads() == 1) {
      body(total, begin, end);
      return total;
    }
    std::vector<T> parts(chunks);
    executor_.parallel_for(chunks, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        body(parts[i], begin + i * kBinningChunk, std::min(end, begin + (i + 1) * kBinningChunk));
    });
    for (const T& part : parts) merge(total, part);
    return total;
  }
  static void merge(Bounds& a, const Bounds& b) { a.extend(b); }
  static void merge(Bins& a, const Bins& b) { a.add(b); }

  Split best_split(const Bins& bins) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& box = bins.box[static_cast<std::size_t>(axis)];
      const auto& counts = bins.count[static_cast<std::size_t>(axis)];
      // Only the bins that hold primitives: in most nodes they are few.
      std::array<std::uint8_t, kBins> used;
      std::size_t bins_used = 0;
      for (std::size_t b = 0; b < kBins; ++b) {
        used[bins_used] = static_cast<std::uint8_t>(b);
        bins_used += counts[b] > 0;
      }
      std::array<float, kBins> right_cost;
      Box4 side;
      std::uint32_t count = 0;
      for (std::size_t i = bins_used - 1; i > 0; --i) {
        side.extend(box[used[i]]);
        count += counts[used[i]];
        right_cost[i] = half_area(side.lo, side.hi) * blocks(count);
      }
      side = Box4{};
      count = 0;
      for (std::size_t i = 1; i < bins_used; ++i) {
        side.extend(box[used[i - 1]]);
        count += counts[used[i - 1]];
        const float cost = half_area(side.lo, side.hi) * blocks(count) + right_cost[i];
        if (cost < best.cost) best = {cost, axis, used[i - 1] + 1};
      }
    }
    return best;
  }

  void make_leaf(std::size_t node, std::size_t begin, std::size_t end) {
    nodes_[node].first = static_cast<std::uint32_t>(begin);
    nodes_[node].right = 0;
    nodes_[node].count = static_cast<std::uint32_t>(end - begin);
  }

  /// Two sides of a node and the bounds of each.
  struct Halves {
    std::size_t middle;
    Bounds left, right;
  };

  Halves halves(std::size_t begin, std::size_t end, const Binning& binning, const Split& split) {
    std::size_t middle = begin + (end - begin) / 2;
    if (split.axis >= 0) {
      BuildPrimitive* const first = primitives_.data();
      middle = static_cast<std::size_t>(std::partition(first + begin, first + end,
                                                       [&](const BuildPrimitive& p) {
                                                         return binning.bin(low(p) + high(p), split.axis) < split.bin;
                                                       }) -
                                        first);
    }
    return {middle, bounds_of(begin, middle), bounds_of(middle, end)};
  }

  /// `free` is the next place for nodes of a subtree that one thread builds.
  void build(std::size_t node, std::size_t begin, std::size_t end, const Bounds& bounds, int depth, std::size_t& free) {
    const std::size_t count = end - begin;
    nodes_[node].box = bounds.box.aabb();
    if (count == 1 || (count <= settings_.leaf_primitives && count <= settings_.block_primitives)) {
      return make_leaf(node, begin, end);
    }
    const Binning binning(bounds.centroids);
    const Split split = depth < kSahDepth ? best_split(bins_of(begin, end, binning)) : Split{};
    const float area = half_area(bounds.box.lo, bounds.box.hi);
    if (count <= settings_.leaf_primitives &&
        !(split.cost + settings_.traversal_cost * area < area * blocks(static_cast<std::uint32_t>(count)))) {
      return make_leaf(node, begin, end);
    }
    const Halves parts = halves(begin, end, binning, split);
    // A subtree over n primitives takes at most 2n - 1 places. One thread fills the places of its subtree from the
    // first on, so that those left over take no memory. Above, the left subtree starts right behind its parent.
    const bool parallel = count >= kParallelNode;
    const std::size_t left = parallel ? node + 1 : free,
                      right = parallel ? node + 2 * (parts.middle - begin) : free + 1;
    if (!parallel) free += 2;
    nodes_[node].first = static_cast<std::uint32_t>(left);
    nodes_[node].right = static_cast<std::uint32_t>(right);
    nodes_[node].count = 0;
    const auto build_side = [&](std::size_t at, std::size_t from, std::size_t to, const Bounds& of) {
      std::size_t own = at + 1;
      build(at, from, to, of, depth + 1, parallel ? own : free);
    };
    const auto build_left = [&] { build_side(left, begin, parts.middle, parts.left); };
    const auto build_right = [&] { build_side(right, parts.middle, end, parts.right); };
    if (parallel) {
      executor_.invoke(build_left, build_right);
    } else {
      build_left();
      build_right();
    }
  }

  BuildPrimitives& primitives_;
  const SahSettings& settings_;
  Executor& executor_;
  BinaryTree nodes_;
};

}  // namespace

BinaryTree build_sah(BuildPrimitives& primitives, const SahSettings& settings, Executor& executor) {
  return Builder(primitives, settings, executor).run();
}

}  // namespace carousel::accel
