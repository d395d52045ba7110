#include "shading/raster/screen.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace carousel::shading {

namespace {

/// Bounds of points in the window, which is [-1, 1] in both directions, y up.
struct Window {
  double lo_x = 1e300, lo_y = 1e300, hi_x = -1e300, hi_y = -1e300;

  void add(double x, double y) {
    // A NaN must widen, never narrow.
    lo_x = x >= lo_x ? lo_x : x;
    lo_y = y >= lo_y ? lo_y : y;
    hi_x = x <= hi_x ? hi_x : x;
    hi_y = y <= hi_y ? hi_y : y;
  }
  bool proper() const {
    return std::isfinite(lo_x) && std::isfinite(lo_y) && std::isfinite(hi_x) && std::isfinite(hi_y);
  }
};

/// Pixels of [lo, hi] in a row of `count`, with one to spare: rays are cast in single precision.
std::pair<std::uint32_t, std::uint32_t> pixels(double lo, double hi, std::uint32_t count) {
  const auto whole = static_cast<double>(count);
  const double first = std::clamp(std::floor((lo + 1) / 2 * whole) - 1, 0.0, whole);
  const double end = std::clamp(std::floor((hi + 1) / 2 * whole) + 2, 0.0, whole);
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)};
}

}  // namespace

Screen::Screen(const scene::Camera& camera, const CameraRays& rays, std::uint32_t width, std::uint32_t height)
    : camera_(camera), half_window_(rays.half_window()), width_(width), height_(height) {}

PixelBox Screen::bounds(std::span<const DVec3> points) const {
  const PixelBox all{0, 0, width_, height_};
  const DVec3 right(camera_.right), up(camera_.up), back(camera_.back), eye(camera_.position);
  DVec3 seen[8];  // right, up, ahead
  double scale = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DVec3 v = points[i] - eye;
    seen[i] = {glm::dot(v, right), glm::dot(v, up), -glm::dot(v, back)};
    scale = std::max({scale, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  Window window;
  if (camera_.projection == scene::Camera::Projection::kOrthographic) {
    for (std::size_t i = 0; i < points.size(); ++i) window.add(seen[i].x / half_window_.x, seen[i].y / half_window_.y);
  } else {
    // Rays start at znear, in single precision, so the bound stands a little before it.
    const double near = 0.9999 * static_cast<double>(camera_.znear);
    const double least = std::max(near, 1e-9 * scale);
    const auto ahead = [&](std::size_t i) { return seen[i].z >= least; };
    const auto count = static_cast<std::size_t>(
        std::count_if(seen, seen + points.size(), [&](const DVec3& p) { return p.z >= least; }));
    if (count < points.size()) {
      const double most =
          std::max_element(seen, seen + points.size(), [](const DVec3& a, const DVec3& b) { return a.z < b.z; })->z;
      if (most < -1e-6 * scale || (count == 0 && near > 0 && most < near)) return {};  // all of it behind
      if (!(near > 1e-9 * scale)) return all;
    }
    const auto add = [&](const DVec3& p) { window.add(p.x / (p.z * half_window_.x), p.y / (p.z * half_window_.y)); };
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (ahead(i)) add(seen[i]);
      for (std::size_t j = 0; j < i; ++j) {  // edges of the hull are among all pairs
        if (ahead(i) == ahead(j)) continue;
        const double s = (least - seen[i].z) / (seen[j].z - seen[i].z);
        add({seen[i].x + s * (seen[j].x - seen[i].x), seen[i].y + s * (seen[j].y - seen[i].y), least});
      }
    }
  }
  if (!window.proper()) return all;
  const auto [x0, x1] = pixels(window.lo_x, window.hi_x, width_);
  const auto [y0, y1] = pixels(-window.hi_y, -window.lo_y, height_);
  return {x0, y0, x1, y1};
}

}  // namespace carousel::shading
