#pragma once

#include <cstdint>
#include <optional>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

struct SamplingConfig {
  double fraction = 1;
  std::optional<std::int64_t> strata;
  std::int64_t seed = 1;
};

namespace config {

template <class V>
void describe(V& v, SamplingConfig& c) {
  v.field("fraction", c.fraction, RealRange{0, 1, true}, "",
          "The part of the picture that is simulated. With less than 1 only tiles drawn over the picture are, and the "
          "report estimates the values of the whole frame.")
      .only(EngineKind::kCycle, "sampled runs");
  v.field_or_auto("strata", c.strata, IntRange{2, 65536}, "strata",
                  "The number of parts of equal size that the picture is divided into. One place, whose tiles are "
                  "neighbours, is drawn from each. auto: as many as leave each place enough neighbours.");
  v.field("seed", c.seed, kSeed, "", "The seed of the draw.");
}

}  // namespace config
}  // namespace carousel
