#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/run/prepare.h"

namespace carousel::app {

struct FollowArguments : ConfigArguments {
  std::string pixel;  ///< X,Y
  std::uint32_t sample = 0, bounce = 0;
  std::optional<std::uint64_t> ray;  ///< a row of hits.csv, in place of the pixel
  bool shadow = false, json = false, quiet = false;
};

/// `carousel follow`: the life of one ray. Returns the exit status.
int follow_command(const FollowArguments& arguments);

}  // namespace carousel::app
