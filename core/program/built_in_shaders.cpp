#include "core/program/built_in_shaders.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "core/types/shader_kind.h"

namespace carousel {

namespace {

/// Operations that a piece of our shading code makes a ray: sums, comparisons and conversions; products; divisions and
/// roots. Of floating point numbers, and of integers the products. Means over rays, counted in the running program by
/// bench/studies/count_operations.py.
struct Counts {
  int simple, product, divide;
  int all() const { return simple + product + divide; }
};
constexpr Counts kMiss{18, 6, 0}, kShadow{16, 4, 0}, kCamera{48, 73, 11}, kUnlit{3, 6, 0}, kAnyHitCounts{13, 11, 0};
/// A plain surface: its geometry, normal and lobes; what a light takes; what a bounce ray takes.
constexpr Counts kSurface{373, 300, 25}, kLight{91, 86, 15}, kBounce{137, 145, 22};

/// Values that live through the shading of a surface, three each: throughput, the way back, the sides of the surface,
/// its normal, two axes of its frame, the origin of new rays, and its colour.
constexpr int kVectors = 8, kAtOnce = 3;

class Text {
 public:
  void line(std::string text) { lines_.push_back(std::move(text)); }
  /// Operations of a piece of the code, its classes spread evenly. They go on three numbers at once, which are then
  /// left for the next three.
  void operations(const Counts& counts) {
    std::array<int, 3> left{counts.simple, counts.product, counts.divide}, due{};
    constexpr std::array<std::string_view, 3> kNames{"add", "mul", "div"};
    for (int i = 0; i < counts.all(); ++i) {
      for (std::size_t c = 0; c < left.size(); ++c) due[c] += left[c];
      const auto most = static_cast<std::size_t>(std::max_element(due.begin(), due.end()) - due.begin());
      due[most] -= counts.all();
      const int vector = made_ / (kAtOnce * 4) % kVectors, number = kAtOnce * vector + made_ % kAtOnce;
      line(fmt::format("{} v{}, v{}, one", kNames[most], number, number));
      ++made_;
    }
  }
  void fill() {
    line("load one, 1");
    line("load eight, 8");
    for (int i = 0; i < kAtOnce * kVectors; ++i) line(fmt::format("mov v{}, one", i));
  }
  /// The products and sums that effects need beyond a plain surface, eight a round.
  void effects() {
    line("mov left, products");
    line("loop 900");
    line("lt done, left, one");
    line("break done");
    for (int i = 0; i < 8; ++i) line(fmt::format("fma v{}, v{}, one, one", i % kAtOnce, i % kAtOnce));
    line("sub left, left, eight");
    line("end");
  }
  void textures() {
    line("mov left, lookups");
    line("loop 64");
    line("lt done, left, one");
    line("break done");
    line("texture colour, v0");
    line("mul v3, v3, colour");
    line("sub left, left, one");
    line("end");
  }
  std::vector<std::string> take() { return std::move(lines_); }

 private:
  std::vector<std::string> lines_;
  int made_ = 0;
};

std::vector<std::string> surface(bool lit) {
  Text out;
  out.line("read material, material");
  out.line("read corners, vertices");
  out.fill();
  out.line("mov v0, corners");
  out.line("mov v3, material");
  if (!lit) {
    out.textures();
    out.operations(kUnlit);
    return out.take();
  }
  out.operations(kSurface);
  out.textures();
  out.effects();
  out.line("if lights");
  out.operations(kLight);
  out.line("trace v0");
  out.line("end");
  out.line("stop last");
  out.operations(kBounce);
  out.line("trace v0");
  return out.take();
}

}  // namespace

std::vector<std::string> built_in_shader(std::size_t kind) {
  const std::string_view name = kShaderKindNames[kind];
  Text out;
  if (name == "miss") {
    out.fill();
    out.operations(kMiss);
    out.textures();
    out.effects();
  } else if (name == "shadow") {
    // A shadow ray loses its light at what it meets, unless that is a pane.
    out.fill();
    out.line("if hit");
    out.effects();
    out.line("else");
    out.operations(kShadow);
    out.line("end");
  } else if (kind == kAnyHitKind) {
    out.line("read material, material");
    out.line("read corners, vertices");
    out.fill();
    out.line("mov v0, corners");
    out.line("mov v3, material");
    out.textures();
    out.operations(kAnyHitCounts);
  } else if (kind == kCameraKind) {
    out.fill();
    out.operations(kCamera);
    out.line("trace v0");
  } else {
    return surface(name != "unlit");
  }
  return out.take();
}

}  // namespace carousel
