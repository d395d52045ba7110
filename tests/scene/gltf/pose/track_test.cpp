#include "scene/gltf/pose/track.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "scene/gltf/pose/slerp.h"

namespace carousel::scene::track_test {
namespace {

TEST(Track, LinearValuesAreBetweenTheirKeysAndClampedOutside) {
  const Track track{.interpolation = Interpolation::kLinear, .width = 2, .times = {1, 3}, .values = {10, 0, 20, 4}};
  EXPECT_EQ(track.at(1.5), (std::vector<double>{12.5, 1}));
  EXPECT_EQ(track.at(0), (std::vector<double>{10, 0}));
  EXPECT_EQ(track.at(1), (std::vector<double>{10, 0}));
  EXPECT_EQ(track.at(3), (std::vector<double>{20, 4}));
  EXPECT_EQ(track.at(1e9), (std::vector<double>{20, 4}));
}

TEST(Track, StepsLastUntilTheNextKey) {
  const Track track{.interpolation = Interpolation::kStep, .times = {0, 1, 2}, .values = {5, 6, 7}};
  EXPECT_EQ(track.at(0.999), std::vector<double>{5});
  EXPECT_EQ(track.at(1), std::vector<double>{6});
  EXPECT_EQ(track.at(2), std::vector<double>{7});
}

// By hand: keys at 1 and 3, so t = 1/4 at 1.5 s and the tangents count twice. The Hermite polynomials there are
// 27/32, 9/64, 5/32 and -3/64.
TEST(Track, CubicSplinesFollowHermitesPolynomials) {
  const Track track{.interpolation = Interpolation::kCubicSpline, .times = {1, 3}, .values = {99, 8, 4, -6, 16, 99}};
  EXPECT_DOUBLE_EQ(track.at(1.5).at(0), 27.0 / 32 * 8 + 2 * 9.0 / 64 * 4 + 5.0 / 32 * 16 + 2 * -3.0 / 64 * -6);
  EXPECT_EQ(track.at(0), std::vector<double>{8});
  EXPECT_EQ(track.at(7), std::vector<double>{16});
}

TEST(Track, OneKeyHoldsForever) {
  for (const auto how : {Interpolation::kLinear, Interpolation::kStep})
    EXPECT_EQ((Track{.interpolation = how, .times = {2}, .values = {5}}.at(1)), std::vector<double>{5});
  EXPECT_EQ((Track{.interpolation = Interpolation::kCubicSpline, .times = {2}, .values = {1, 5, 1}}.at(3)),
            std::vector<double>{5});
}

TEST(Slerp, TurnsEvenlyAlongTheShorterArc) {
  // Against the C library, which the program does not use for it.
  for (const double angle : {0.0, 1e-9, 0.001, 0.5, 1.5, 2.5, 3.1}) {
    const glm::dvec4 a(0, 0, 0, 1), b(0, 0, std::sin(angle / 2), std::cos(angle / 2));
    for (const double t : {0.0, 0.1, 1.0 / 3, 0.5, 1.0}) {
      for (const double sign : {1.0, -1.0}) {  // one rotation has two quaternions
        const glm::dvec4 q = slerp(a, sign * b, t);
        EXPECT_NEAR(q.z, std::sin(t * angle / 2), 1e-14) << angle << " " << t;
        EXPECT_NEAR(q.w, std::cos(t * angle / 2), 1e-14) << angle << " " << t;
      }
    }
  }
}

TEST(Slerp, OfATrackStartsFromQuaternionsOfAnyLength) {
  const Track track{.width = 4, .times = {0, 3}, .values = {0, 0, 0, 2, 0, 0, 5, 5}, .rotation = true};
  const std::vector<double> q = track.at(1);  // a third of 90 degrees
  EXPECT_NEAR(q[2], std::sin(std::numbers::pi / 12), 1e-12);
  EXPECT_NEAR(q[3], std::cos(std::numbers::pi / 12), 1e-12);
}

}  // namespace
}  // namespace carousel::scene::track_test
