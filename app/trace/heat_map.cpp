#include "app/trace/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/system/atomic_file.h"
#include "report/text/ratio.h"
#include "shading/camera/image_file.h"

namespace carousel::app {

namespace {

using ringbus::PixelCost;

std::uint64_t waiting(const PixelCost& pixel) {
  return pixel.cycles - pixel.in_test;
}

struct HeatValue {
  const char* name;
  std::uint64_t (*of)(const PixelCost&);
};
constexpr std::array<HeatValue, 4> kHeatValues{{
    {"cycles", [](const PixelCost& p) { return p.cycles; }},
    {"tests", [](const PixelCost& p) { return p.tests; }},
    {"hops", [](const PixelCost& p) { return p.hops; }},
    {"waiting", waiting},
}};

/// From dark to bright, so that it reads without colours, too; `at` from 0 to 1.
std::array<std::uint8_t, 3> heat_color(double at) {
  constexpr std::array<std::array<double, 3>, 5> kStops{
      {{0, 0, 8}, {80, 18, 110}, {190, 55, 80}, {250, 145, 10}, {252, 255, 170}}};
  const double place = std::clamp(at, 0.0, 1.0) * (kStops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double part = place - static_cast<double>(below);
  std::array<std::uint8_t, 3> out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = static_cast<std::uint8_t>(std::lround(kStops[below][c] * (1 - part) + kStops[below + 1][c] * part));
  return out;
}

/// The places of a quantity's values between 0 and 1. By logarithms the least value above 0 is at kFirst, so that
/// values which are large and near one another differ, and 0 stands below it. web/src/heat_map.js has the same scale.
class HeatScale {
 public:
  HeatScale(std::span<const PixelCost> pixels, const HeatValue& value, bool log) : log_(log) {
    for (const PixelCost& pixel : pixels) {
      const auto v = static_cast<double>(value.of(pixel));
      most_ = std::max(most_, v);
      if (v > 0) least_ = least_ > 0 ? std::min(least_, v) : v;
    }
    log_ = log_ && least_ < most_;
  }
  double place(std::uint64_t value) const {
    constexpr double kFirst = 0.08;
    const auto v = static_cast<double>(value);
    if (!log_) return report::ratio(v, most_);
    return v > 0 ? kFirst + (1 - kFirst) * std::log(v / least_) / std::log(most_ / least_) : 0;
  }

 private:
  bool log_;
  double least_ = 0, most_ = 0;
};

}  // namespace

std::optional<report::Heat> heat_section(std::span<const PixelCost> pixels, std::uint32_t width) {
  constexpr std::size_t kListed = 10;
  std::vector<std::size_t> traced;
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i].rays == 0) continue;
    traced.push_back(i);
    sum += static_cast<double>(pixels[i].cycles);
  }
  if (traced.empty()) return std::nullopt;
  report::Heat out{sum / static_cast<double>(traced.size()), {}};
  const auto shown = traced.begin() + static_cast<std::ptrdiff_t>(std::min(kListed, traced.size()));
  std::partial_sort(traced.begin(), shown, traced.end(), [&](std::size_t a, std::size_t b) {
    return pixels[a].cycles != pixels[b].cycles ? pixels[a].cycles > pixels[b].cycles : a < b;
  });
  for (auto i = traced.begin(); i != shown; ++i) {
    const PixelCost& p = pixels[*i];
    out.slowest.push_back({*i % width, *i / width, p.rays, p.cycles, p.tests, p.hops, waiting(p)});
  }
  return out;
}

void write_heat(const std::filesystem::path& folder, std::span<const PixelCost> pixels, std::uint32_t width, bool log) {
  const auto height = static_cast<std::uint32_t>(pixels.size() / width);
  std::vector<std::uint8_t> rgb(3 * pixels.size());
  for (const HeatValue& value : kHeatValues) {
    const HeatScale scale(pixels, value, log);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto color = heat_color(scale.place(value.of(pixels[i])));
      std::copy(color.begin(), color.end(), rgb.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    shading::write_png_bytes(folder / fmt::format("heat_{}.png", value.name), width, height, rgb);
  }
  std::string csv = "x,y,rays,cycles,tests,hops,waiting\n";
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PixelCost& p = pixels[i];
    csv += fmt::format("{},{},{},{},{},{},{}\n", i % width, i / width, p.rays, p.cycles, p.tests, p.hops, waiting(p));
  }
  write_file(folder / "heat.csv", csv);
}

}  // namespace carousel::app
