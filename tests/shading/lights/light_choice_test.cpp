#include "shading/lights/light_choice.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::shading {
namespace {

TEST(LightChoice, ChoosesInProportion) {
  const std::vector<float> weights{1, 0, 2, 5, 0};
  const LightChoice choice(weights);
  std::vector<int> counts(weights.size());
  for (std::uint64_t i = 0; i < 8000; ++i) ++counts[choice.choose(std::uint32_t((i << 32) / 8000))];
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(counts[i], 1000 * weights[i], 1) << i;
    EXPECT_NEAR(choice.probability(std::uint32_t(i)), weights[i] / 8, 1e-6f) << i;
  }
  EXPECT_EQ(counts[1], 0);
  EXPECT_EQ(counts[4], 0);
}

TEST(LightChoice, NeverChoosesWhatHasNoWeight) {
  for (const std::vector<float>& weights : {std::vector<float>{0, 1, 0}, {0, 0, 3}, {3, 0, 0}, {1e-30f, 1}}) {
    const LightChoice choice(weights);
    for (const std::uint32_t word : {0u, 1u, 0x7fffffffu, 0xfffffffeu, 0xffffffffu}) {
      EXPECT_GT(choice.probability(choice.choose(word)), 0.0f);
    }
  }
}

TEST(LightChoice, ProbabilitiesAddUpToOne) {
  std::vector<float> weights;
  for (int i = 0; i < 1000; ++i) weights.push_back(float(i % 7) * 0.1f);
  const LightChoice choice(weights);
  double sum = 0;
  for (std::uint32_t i = 0; i < weights.size(); ++i) sum += double{choice.probability(i)};
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(LightChoice, IsEmptyWithoutWeight) {
  EXPECT_TRUE(LightChoice().empty());
  EXPECT_TRUE(LightChoice(std::vector<float>{0, 0}).empty());
}

}  // namespace
}  // namespace carousel::shading
