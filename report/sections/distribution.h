#pragma once

#include <cstdint>
#include <vector>

#include "core/numeric/log2_histogram.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// A class of a distribution.
struct DistributionClass {
  std::uint64_t from = 0, to = 0, count = 0;
};

template <class V>
void describe(V& v, const DistributionClass& r) {
  v.field("from", r.from, "cycles", "least value of the class");
  v.field("to", r.to, "cycles", "greatest value of the class");
  v.field("count", r.count, "values", "number of values in the class");
}

/// A distribution of times in classes that double.
struct Distribution {
  std::uint64_t count = 0;
  double mean = 0;
  std::uint64_t max = 0;
  std::vector<DistributionClass> classes{};
};

/// Without the classes before the first and behind the last value.
inline Distribution distribution_of(const Log2Histogram& of) {
  Distribution out{of.count(), ratio(of.sum(), of.count()), of.max(), {}};
  for (std::size_t i = 0; i < Log2Histogram::kClasses && Log2Histogram::least(i) <= of.max(); ++i) {
    if (out.classes.empty() && of.in_class(i) == 0) continue;
    const std::uint64_t next = i + 1 < Log2Histogram::kClasses ? Log2Histogram::least(i + 1) : 0;
    out.classes.push_back({Log2Histogram::least(i), next - 1, of.in_class(i)});
  }
  return out;
}

template <class V>
void describe(V& v, const Distribution& r) {
  v.field("count", r.count, "values", "number of values in all");
  v.field("mean", r.mean, "cycles", "mean");
  v.field("max", r.max, "cycles", "greatest value");
  v.section("classes", r.classes, "number of values in each class; the width of the classes doubles");
}

}  // namespace carousel::report
