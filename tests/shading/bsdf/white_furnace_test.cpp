// A white surface in a white world is invisible: any combination of lobes returns all the light. Combinations are drawn
// at random; the limits of each kind of base and layer are drawn more often than others.

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/interface_bsdf.h"
#include "shading/bsdf/layered_bsdf.h"
#include "shading/math/luminance.h"
#include "tests/shading/bsdf/bsdf_integrals.h"
#include "tests/support/random_runs.h"

namespace carousel::shading {
namespace {

enum class Base { kOpaque, kThinWall, kGlass, kInsideGlass };

class Draw {
 public:
  explicit Draw(std::uint32_t seed) : random_(seed) {}
  float uniform(float from = 0, float to = 1) { return std::uniform_real_distribution<float>(from, to)(random_); }
  /// A value `from`, `to`, or between them.
  float often_at_the_ends(float from = 0, float to = 1) {
    const int which = std::uniform_int_distribution<int>(0, 3)(random_);
    return which == 0 ? from : which == 1 ? to : uniform(from, to);
  }
  bool one_in(int n) { return std::uniform_int_distribution<int>(1, n)(random_) == 1; }
  template <class T, std::size_t kCount>
  T among(const T (&values)[kCount]) {
    return values[std::uniform_int_distribution<std::size_t>(0, kCount - 1)(random_)];
  }

 private:
  std::mt19937 random_;
};

struct Case {
  InterfacePoint point;
  LayerPoint layers;
  Vec3 wo;
};

Case draw_case(Draw& draw, Base base, bool stretched, bool layered) {
  Case c;
  InterfacePoint& p = c.point;
  const float roughness = draw.often_at_the_ends();
  p.material = {Vec3{1}, draw.one_in(2) ? 0.0f : draw.often_at_the_ends(), roughness};
  const float alpha = ggx_alpha(roughness), strength = stretched ? draw.often_at_the_ends(0.1f) : 0.0f;
  p.alpha = {alpha + (1 - alpha) * strength * strength, alpha};
  float cosine = draw.uniform(0.03f, 1);
  float f0 = 0.04f;
  if (base != Base::kOpaque) p.transmission = draw.often_at_the_ends(0.05f);
  if (base == Base::kGlass || base == Base::kInsideGlass) {
    const float ior = draw.among({1.1f, 1.5f, 2.4f});
    p.eta = base == Base::kGlass ? ior : 1 / ior;
    p.glass = &GlassAlbedo::of(p.eta);
    f0 = f0_of_eta(ior);
    if (base == Base::kInsideGlass && draw.one_in(2))  // near the critical angle everything changes
      cosine = std::clamp(std::sqrt(1 - p.eta * p.eta) + draw.uniform(-0.03f, 0.03f), 0.03f, 1.0f);
  }
  p.dielectric_f90 = draw.one_in(2) ? 1.0f : draw.uniform(0.1f);
  const auto colour = [&] { return Vec3{draw.uniform(), draw.uniform(), draw.uniform()}; };
  // Weight and colour of KHR_materials_specular, with the values that iridescence may produce.
  p.dielectric_f0 = (draw.one_in(2) ? Vec3{f0} : colour()) * p.dielectric_f90;
  c.wo = direction(cosine, draw.often_at_the_ends(0, 0.25f));
  if (layered) {
    c.layers.coat = draw.often_at_the_ends();
    c.layers.coat_roughness = draw.often_at_the_ends();
    // Grey: coloured sheen takes its largest channel from what lies below, as KHR_materials_sheen says, and absorbs.
    c.layers.sheen = Vec3{draw.often_at_the_ends()};
    c.layers.sheen_roughness = draw.often_at_the_ends();
  }
  return c;
}

Vec3 furnace(const Case& c, bool transmits, bool layered, std::uint32_t samples) {
  const auto with_layers = [&](const auto& base) {
    return layered ? white_albedo(LayeredBsdf(c.layers, base, c.wo), samples) : white_albedo(base, samples);
  };
  return transmits ? with_layers(InterfaceBsdf<true>(c.point, c.wo)) : with_layers(InterfaceBsdf<false>(c.point, c.wo));
}

void expect_white(Base base, bool stretched, bool layered) {
  Draw draw(run_seed() * 31 + static_cast<std::uint32_t>(base) * 4 + (stretched ? 2 : 0) + (layered ? 1 : 0));
  for (int i = 0; i < scaled(40); ++i) {
    const Case c = draw_case(draw, base, stretched, layered);
    const InterfacePoint& p = c.point;
    Vec3 a = furnace(c, base != Base::kOpaque, layered, 1 << 12);
    const auto far_off = [&] { return max_component(glm::abs(a - Vec3{1})) > 0.006f; };
    // More samples tell noise from a wrong surface.
    if (far_off()) a = furnace(c, base != Base::kOpaque, layered, 1 << 15);
    if (far_off()) a = furnace(c, base != Base::kOpaque, layered, 1 << 18);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(a[k], 1, 0.01) << fmt::format(
          "case {}: metallic {} alpha {} {} transmission {} eta {} f0 {} f90 {} from {} {} {}; coat {} {} sheen {} {}",
          i, p.material.metallic, p.alpha.x, p.alpha.y, p.transmission, p.eta, p.dielectric_f0[k], p.dielectric_f90,
          c.wo.x, c.wo.y, c.wo.z, c.layers.coat, c.layers.coat_roughness, c.layers.sheen[k], c.layers.sheen_roughness);
    }
  }
}

TEST(WhiteFurnace, OpaqueBoundariesOfAnyKind) {
  expect_white(Base::kOpaque, false, false);
}
TEST(WhiteFurnace, StretchedHighlights) {
  expect_white(Base::kOpaque, true, false);
}
TEST(WhiteFurnace, ThinWalls) {
  expect_white(Base::kThinWall, false, false);
  expect_white(Base::kThinWall, true, false);
}
TEST(WhiteFurnace, GlassThatLetsAllOrSomeThrough) {
  expect_white(Base::kGlass, false, false);
  expect_white(Base::kGlass, true, false);
}
TEST(WhiteFurnace, GlassFromInside) {
  expect_white(Base::kInsideGlass, false, false);
  expect_white(Base::kInsideGlass, true, false);
}
TEST(WhiteFurnace, LayersOverEveryBase) {
  for (const Base base : {Base::kOpaque, Base::kThinWall, Base::kGlass}) {
    expect_white(base, false, true);
    expect_white(base, true, true);
  }
}

}  // namespace
}  // namespace carousel::shading
