#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/load/load.h"
#include "core/config/write.h"
#include "tests/core/config/random_config.h"

namespace carousel {
namespace {

TEST(ConfigWrite, ResolvedYamlReadsBackToTheSameConfig) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Config config = random_config(seed);
    const Config again = load_config({resolved_yaml(config), "resolved.yaml"}, {}, {.fields_only = true}).config;
    ASSERT_EQ(config_json(again), config_json(config)) << seed;
    ASSERT_EQ(again.scene.sky.value_or(SkyConfig{}).color, config.scene.sky.value_or(SkyConfig{}).color);
    ASSERT_EQ(again.camera.aperture, config.camera.aperture);
  }
}

TEST(ConfigWrite, JsonReadsBackToTheSameConfig) {
  for (std::uint64_t seed = 1000; seed < 1100; ++seed) {
    const Config config = random_config(seed);
    const Config again = load_config({config_json(config).dump(1), "resolved.json"}, {}, {.fields_only = true}).config;
    ASSERT_EQ(config_json(again), config_json(config)) << seed;
  }
}

TEST(ConfigWrite, FloatsKeepTheirShortestForm) {
  Config config;
  config.camera.aperture = 0.1f;
  EXPECT_EQ(config_json(config)["camera"]["aperture"].dump(), "0.1");
}

TEST(ConfigWrite, EnumNamesAreUniqueAndReadBack) {
  for (const auto& entry : kEnumNames<TopologyShape>) {
    EXPECT_EQ(enum_value<TopologyShape>(entry.name), entry.value);
    EXPECT_EQ(enum_name(entry.value), entry.name);
  }
  EXPECT_FALSE(enum_value<Policy>("none").has_value());
}

}  // namespace
}  // namespace carousel
