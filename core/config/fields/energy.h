#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"
#include "core/costs/cost_table.h"

namespace carousel {

template <>
inline constexpr auto kEnumNames<CostProfile> = [] {
  using enum CostProfile;
  return names<CostProfile>({{kNone, "none"}, {kN45, "n45"}, {kN7, "n7"}});
}();

/// The numbers that a configuration gives itself, by the rows of kCostTable. Absent: those of the profile.
using OwnCosts = std::array<std::optional<float>, kCostTable.size()>;

struct EnergyConfig {
  CostProfile profile = CostProfile::kNone;
  OwnCosts own;  ///< values for the rows of this section, where given
};

struct AreaConfig {
  std::optional<float> budget_mm2;
  enum class Fit { kResources, kAll, kBest, kRefuse } fit = Fit::kResources;
  enum class Aim { kCycles, kJoules } aim = Aim::kCycles;  ///< of a search for the best split
  std::optional<float> link_mm;                            ///< absent: the side of a square of a resource's area
  OwnCosts own;                                            ///< values for the rows of this section, where given
};

template <>
inline constexpr auto kEnumNames<AreaConfig::Fit> = [] {
  using enum AreaConfig::Fit;
  return names<AreaConfig::Fit>({{kResources, "resources"}, {kAll, "all"}, {kBest, "best"}, {kRefuse, "refuse"}});
}();

template <>
inline constexpr auto kEnumNames<AreaConfig::Aim> = [] {
  using enum AreaConfig::Aim;
  return names<AreaConfig::Aim>({{kCycles, "cycles"}, {kJoules, "joules"}});
}();

namespace config {

template <class V>
void describe_costs(V& v, OwnCosts& own, std::string_view section) {
  for (std::size_t i = 0; i < kCostTable.size(); ++i)
    if (kCostTable[i].section == section)
      v.field_or_auto(kCostTable[i].key, own[i], RealRange{0, 1e9}, kCostTable[i].unit, kCostTable[i].meaning);
}

template <class V>
void describe(V& v, EnergyConfig& c) {
  v.choice("profile", c.profile,
           "The process whose numbers energy and area have where they say auto: 45 nm with DDR3, or 7 nm with GDDR6. "
           "With none neither is computed.")
      .only(EngineKind::kCycle, "count of joules", CostProfile::kN45, CostProfile::kN7);
  describe_costs(v, c.own, "energy");
}

template <class V>
void describe(V& v, AreaConfig& c) {
  v.field_or_auto("budget_mm2", c.budget_mm2, RealRange{0, 1e6, true}, "mm2",
                  "The largest area of the machine. With auto there is no bound.");
  v.choice(
       "fit", c.fit,
       "With a budget the machine gets the largest number of resources that stays within it, whatever "
       "topology.resources says. With all, shading.workers grows by the same factor, and so do size and banks of an "
       "L2 that all resources share. With best at most 40 splits between resources, their testers, shared caches, "
       "ports and shader workers are simulated, from the machine of all on, and the best is taken, by area.aim. With "
       "refuse a larger machine is an error.")
      .only(EngineKind::kCycle, "search for the best split", AreaConfig::Fit::kBest);
  v.choice("aim", c.aim,
           "The best split takes the fewest cycles for the frame, or the fewest joules a completed ray "
           "(energy.nj_per_ray).");
  v.field_or_auto(
      "link_mm", c.link_mm, RealRange{0, 1000}, "mm",
      "The length of a link between neighbours. With auto it is the side of a square of a resource's area.");
  describe_costs(v, c.own, "area");
}

}  // namespace config
}  // namespace carousel
