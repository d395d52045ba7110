#include "shading/lights/sky_facts.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "shading/math/luminance.h"
#include "shading/math/spherical.h"

namespace carousel::shading {

SkyFacts sky_facts(const scene::SkyMap& map) {
  constexpr double kHundredth = 0.01;
  SkyFacts facts;
  DVec3 mean{0};
  double light = 0;
  std::vector<std::pair<float, double>> texels;  // luminance, share of the sphere
  texels.reserve(map.texels.size());
  for (std::uint32_t y = 0; y < map.height; ++y) {
    const double belt = cos_half_turns(double(y) / map.height) - cos_half_turns(double(y + 1) / map.height);
    const double share = belt / 2 / map.width;
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const Vec3& texel = map.texels[std::size_t{y} * map.width + x];
      mean += DVec3(texel) * share;
      texels.emplace_back(luminance(texel), share);
      light += double{texels.back().first} * share;
    }
  }
  facts.mean = Vec3(mean);
  std::sort(texels.begin(), texels.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  facts.most = texels.front().first;
  double left = kHundredth, bright = 0;
  for (const auto& [luminance, share] : texels) {
    const double taken = std::min(share, left);
    bright += double{luminance} * taken;
    left -= taken;
    if (!(left > 0)) break;
  }
  facts.brightest_percent = light > 0 ? bright / light : 0;
  return facts;
}

}  // namespace carousel::shading
