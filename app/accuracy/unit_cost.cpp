#include "app/accuracy/unit_cost.h"

#include "core/config/costs.h"

namespace carousel::app {

double unit_area_mm2(const TestersConfig& testers, const AccuracyConfig& accuracy) {
  double out = 0;
  for (const UnitKind kind : {UnitKind::kBox, UnitKind::kTriangle, UnitKind::kTransform})
    out +=
        static_cast<double>(testers.units[kind].units) * method_area_mm2(accuracy, kind, *test_method(accuracy, kind));
  return out;
}

double test_energy_pj(const IntersectionCounts& counts, const AccuracyConfig& accuracy) {
  const auto tests = [&](UnitKind kind, std::uint64_t number) {
    const TestMethod of = *test_method(accuracy, kind);
    return static_cast<double>(number) * energy_of(of.method, kPicojoules45, of.arithmetic);
  };
  const auto wide = [&](Method method, std::uint64_t number) {
    return static_cast<double>(number) * energy_of(method, kPicojoules45, {.wide = true});
  };
  return tests(UnitKind::kBox, counts.box) + tests(UnitKind::kPlane, counts.plane) +
         tests(UnitKind::kTriangle, counts.triangle) + wide(Method::kExactVolume, counts.exact_volumes) +
         wide(Method::kWatertight, counts.refined) +
         tests(UnitKind::kTransform, counts.transforms - counts.transforms_in_double) +
         wide(Method::kTwoStep, counts.transforms_in_double);
}

}  // namespace carousel::app
