// A workload as a plugin: `workload: {plugin: scanner, options: {beams: 500}}`.
#include <cstdint>
#include <memory>

#include "ringbus/plugin/bring.h"
#include "scanner.h"

namespace {

carousel::MadeWorkload make_scanner(const carousel::WorkloadSetup& setup) {
  const auto beams = static_cast<std::uint32_t>(setup.options.at("beams"));
  const carousel::Vec3 middle = 0.5f * (setup.scene.lo + setup.scene.hi);
  return {std::make_unique<scanner::Scanner>(middle, beams), beams};
}

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("range scanner", "1.0", [](carousel::PluginParts& parts) {
    carousel::ringbus::bring_workload(parts, "scanner",
                                      {.options = {{.name = "beams",
                                                    .standard = 2000,
                                                    .least = 1,
                                                    .most = 1e6,
                                                    .unit = "beams",
                                                    .meaning = "The number of beams, spread over the sphere."}},
                                       .make = make_scanner});
  });
  return &info;
}
