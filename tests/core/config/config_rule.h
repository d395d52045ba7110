#pragma once

#include <gtest/gtest.h>

#include "tests/core/config/bad_config.h"

/// The least that a configuration has to say.
#define SCENE "scene: {builtin: cornell}\n"

namespace carousel {

/// A rule by which keys do not go together. config_rules_test.cpp tests it; files by subject have the rules.
class ConfigRule : public testing::TestWithParam<BadConfig> {};

}  // namespace carousel
