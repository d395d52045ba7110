#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "shading/camera/pixel_order.h"
#include "shading/math/disk.h"
#include "shading/math/sampler.h"
#include "shading/math/shading_basis.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {
namespace {

TEST(PixelOrder, VisitsEveryPathOnce) {
  for (const auto& [width, height, samples] : {std::tuple{1u, 1u, 1u}, {16u, 8u, 3u}, {21u, 13u, 2u}, {3u, 50u, 1u}}) {
    const PixelOrder order(width, height, samples);
    std::vector<bool> seen(order.count());
    for (std::uint64_t i = 0; i < order.count(); ++i) {
      const PixelSample p = order.at(i);
      ASSERT_LT(p.x, width);
      ASSERT_LT(p.y, height);
      ASSERT_LT(p.sample, samples);
      const std::size_t name = (std::size_t{p.y} * width + p.x) * samples + p.sample;
      EXPECT_FALSE(seen[name]);
      seen[name] = true;
    }
  }
}

TEST(PixelOrder, NeighboursInTimeAreNeighboursInTheImage) {
  const PixelOrder order(64, 64, 4);
  for (std::uint64_t i = 0; i + 16 <= order.count(); i += 16) {
    for (std::uint64_t k = 1; k < 16; ++k) {
      EXPECT_EQ(order.at(i).x / 4, order.at(i + k).x / 4);
      EXPECT_EQ(order.at(i).y / 4, order.at(i + k).y / 4);
    }
  }
}

TEST(Sampler, SamplesOfAPixelFallIntoDifferentStrata) {
  for (const std::uint32_t count : {1u, 4u, 7u, 16u, 60u}) {
    const Sampler sampler(9, count);
    for (std::uint32_t pixel = 0; pixel < 50; ++pixel) {
      std::vector<int> rows(count), lobes(count);
      std::vector<std::uint32_t> choices;
      for (std::uint32_t s = 0; s < count; ++s) {
        ++rows[std::size_t(sampler.camera(pixel, s).pixel.y * float(count))];
        ++lobes[std::size_t(sampler.direction(pixel, s, 0).lobe * float(count))];
        choices.push_back(sampler.light(pixel, s, 0).choice);
      }
      EXPECT_EQ(*std::max_element(rows.begin(), rows.end()), 1);
      EXPECT_EQ(*std::max_element(lobes.begin(), lobes.end()), 1);
      std::sort(choices.begin(), choices.end());
      for (std::uint32_t s = 0; s < count; ++s) EXPECT_EQ(std::uint64_t{choices[s]} * count >> 32, s);
    }
  }
}

TEST(Sampler, SquareCountsFillBothAxes) {
  const Sampler sampler(9, 16);
  for (std::uint32_t pixel = 0; pixel < 50; ++pixel) {
    std::vector<int> cells(16);
    for (std::uint32_t s = 0; s < 16; ++s) {
      const Vec2 p = sampler.direction(pixel, s, 0).direction;
      ++cells[std::size_t(p.x * 4) + 4 * std::size_t(p.y * 4)];
    }
    EXPECT_EQ(*std::max_element(cells.begin(), cells.end()), 1);
  }
}

TEST(Sampler, MarginsAreUniformWhateverTheCount) {
  for (const std::uint32_t count : {3u, 7u}) {
    const Sampler sampler(1, count);
    double x = 0, y = 0, xy = 0;
    constexpr int kPixels = 20000;
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
      const Vec2 p = sampler.camera(pixel, pixel % count).pixel;
      x += double{p.x} / kPixels;
      y += double{p.y} / kPixels;
      xy += double{p.x} * double{p.y} / kPixels;
    }
    EXPECT_NEAR(x, 0.5, 0.01);
    EXPECT_NEAR(y, 0.5, 0.01);
    EXPECT_NEAR(xy, 0.25, 0.01);
  }
}

TEST(Trigonometry, IsAccurate) {
  for (int i = -4000; i <= 4000; ++i) {
    const float turns = float(i) / 1000;
    const SinCos r = sin_cos_turns(turns);
    const double angle = 2 * M_PI * double{turns};
    EXPECT_NEAR(r.sin, std::sin(angle), 2e-6);
    EXPECT_NEAR(r.cos, std::cos(angle), 2e-6);
    EXPECT_NEAR(r.sin * r.sin + r.cos * r.cos, 1.0f, 1e-6f);
  }
}

TEST(Disk, KeepsAreas) {
  constexpr int kSteps = 200;
  int inner = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Vec2 p = square_to_disk({(float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps});
      EXPECT_LE(glm::length(p), 1.0f);
      inner += glm::length(p) < 0.5f ? 1 : 0;
    }
  }
  EXPECT_NEAR(inner, kSteps * kSteps / 4, 200);
}

TEST(ShadingBasis, IsOrthonormalAndRightHanded) {
  for (const Vec3& v : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, 1, -1e-8f}, Vec3{1, 2, -3}}) {
    const ShadingBasis frame(glm::normalize(v));
    EXPECT_NEAR(glm::dot(frame.tangent, frame.bitangent), 0, 1e-6f);
    EXPECT_NEAR(glm::dot(frame.tangent, frame.normal), 0, 1e-6f);
    EXPECT_NEAR(glm::length(frame.tangent), 1, 1e-6f);
    EXPECT_NEAR(glm::dot(glm::cross(frame.tangent, frame.bitangent), frame.normal), 1, 1e-6f);
    EXPECT_NEAR(glm::length(frame.to_world(frame.to_local({3, 4, 5})) - Vec3(3, 4, 5)), 0, 1e-5f);
  }
}

}  // namespace
}  // namespace carousel::shading
