#pragma once

#include <cstdint>

#include "core/config/fields/field.h"

namespace carousel {

struct ReportConfig {
  std::int64_t samples = 256;
};

namespace config {

template <class V>
void describe(V& v, ReportConfig& c) {
  v.field("samples", c.samples, IntRange{16, 65536}, "samples",
          "The most samples of a row of the report's time series. A machine of so many parts that all rows would hold "
          "more than 2^18 numbers gets fewer.");
}

}  // namespace config
}  // namespace carousel
