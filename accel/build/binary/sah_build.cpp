#include "accel/build/binary/sah_build.h"

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

/// Maps a doubled centroid to its bin on all axes at once.
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
  }
  int bin(Float4 centroid, int axis) const {
    const float b = (centroid[axis] - origin[axis]) * scale[axis];
    return b > 0 ? (b < kBins ? static_cast<int>(b) : kBins - 1) : 0;  // NaN (sums that overflowed): bin 0
  }
};

struct Bins {
  std::array<std::array<Box4, kBins>, 3> box;
  std::array<std::array<std::uint32_t, kBins>, 3> count{};

  void add(std::span<const BuildPrimitive> primitives, const Binning& binning) {
    for (const BuildPrimitive& p : primitives) {
      const Float4 lo = low(p), hi = high(p), c = lo + hi;
      for (int a = 0; a < 3; ++a) {
        const int b = binning.bin(c, a);
        box[a][b].extend(lo, hi);
        ++count[a][b];
      }
    }
  }
  void add(const Bins& other) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < kBins; ++b) {
        box[a][b].extend(other.box[a][b]);
        count[a][b] += other.count[a][b];
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
  Builder(std::vector<BuildPrimitive>& primitives, const SahSettings& settings, Executor& executor)
      : primitives_(primitives), settings_(settings), executor_(executor), nodes_(2 * primitives.size() - 1) {}

  std::vector<BinaryNode> run() {
    build(0, 0, primitives_.size(), bounds_of(0, primitives_.size()), 0);
    return std::move(nodes_);
  }

 private:
  float blocks(std::size_t n) const {
    return static_cast<float>((n + settings_.block_primitives - 1) / settings_.block_primitives);
  }

  std::span<const BuildPrimitive> range(std::size_t begin, std::size_t end) const {
    return {primitives_.data() + begin, end - begin};
  }

  Bounds bounds_of(std::size_t begin, std::size_t end) {
    return reduce<Bounds>(begin, end, [this](Bounds& out, std::size_t b, std::size_t e) {
      for (const BuildPrimitive& p : range(b, e)) out.extend(p);
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
      std::array<float, kBins> right_cost{};
      Box4 box;
      std::size_t count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        box.extend(bins.box[axis][b]);
        count += bins.count[axis][b];
        right_cost[b] = count ? half_area(box.lo, box.hi) * blocks(count) : 0.0f;
      }
      const std::size_t total = count + bins.count[axis][0];
      box = Box4{};
      count = 0;
      for (int b = 1; b < kBins; ++b) {
        box.extend(bins.box[axis][b - 1]);
        count += bins.count[axis][b - 1];
        if (count == 0 || count == total) continue;
        const float cost = half_area(box.lo, box.hi) * blocks(count) + right_cost[b];
        if (cost < best.cost) best = {cost, axis, b};
      }
    }
    return best;
  }

  void make_leaf(std::size_t node, std::size_t begin, std::size_t end) {
    nodes_[node].first = static_cast<std::uint32_t>(begin);
    nodes_[node].count = static_cast<std::uint32_t>(end - begin);
  }

  void build(std::size_t node, std::size_t begin, std::size_t end, const Bounds& bounds, int depth) {
    const std::size_t count = end - begin;
    nodes_[node].box = bounds.box.aabb();
    if (count == 1 || (count <= settings_.leaf_primitives && count <= settings_.block_primitives)) {
      return make_leaf(node, begin, end);
    }
    const Binning binning(bounds.centroids);
    const Split split = depth < kSahDepth ? best_split(bins_of(begin, end, binning)) : Split{};
    const float area = half_area(bounds.box.lo, bounds.box.hi);
    if (count <= settings_.leaf_primitives && !(split.cost + settings_.traversal_cost * area < area * blocks(count))) {
      return make_leaf(node, begin, end);
    }
    std::size_t middle = begin + count / 2;
    if (split.axis >= 0) {
      const auto it = std::partition(
          primitives_.begin() + static_cast<std::ptrdiff_t>(begin),
          primitives_.begin() + static_cast<std::ptrdiff_t>(end),
          [&](const BuildPrimitive& p) { return binning.bin(low(p) + high(p), split.axis) < split.bin; });
      middle = static_cast<std::size_t>(it - primitives_.begin());
    }
    // A subtree over n primitives takes at most 2n - 1 places: the left one starts right behind its parent.
    const std::size_t left = node + 1, right = node + 2 * (middle - begin);
    nodes_[node].first = static_cast<std::uint32_t>(left);
    nodes_[node].right = static_cast<std::uint32_t>(right);
    const auto build_left = [&] { build(left, begin, middle, bounds_of(begin, middle), depth + 1); };
    const auto build_right = [&] { build(right, middle, end, bounds_of(middle, end), depth + 1); };
    if (count >= kParallelNode) {
      executor_.invoke(build_left, build_right);
    } else {
      build_left();
      build_right();
    }
  }

  std::vector<BuildPrimitive>& primitives_;
  const SahSettings& settings_;
  Executor& executor_;
  std::vector<BinaryNode> nodes_;
};

}  // namespace

std::vector<BinaryNode> build_sah(std::vector<BuildPrimitive>& primitives, const SahSettings& settings,
                                  Executor& executor) {
  return Builder(primitives, settings, executor).run();
}

}  // namespace carousel::accel
