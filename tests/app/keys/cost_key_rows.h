#pragma once

#include <string>
#include <vector>

#include "core/costs/cost_table.h"
#include "tests/app/keys/key_row.h"

namespace carousel {

/// The rows of energy and area.
inline std::vector<KeyRow> cost_key_rows() {
  using enum BaseMachine;
  std::vector<KeyRow> rows{
      {"energy.profile", kTerrain},
      {"area.budget_mm2", kTerrain, {"energy.profile=n45"}, {"30"}},
      {"area.fit", kTerrain, {"energy.profile=n45", "area.budget_mm2=300", "area.fit=resources"}, {"all", "refuse"}},
      {"area.fit", kTerrain, {"energy.profile=n45", "area.budget_mm2=12"}, {"best"}},
      {"area.aim", kTerrain, {"energy.profile=n45", "area.budget_mm2=12", "area.fit=best"}},
      {"area.link_mm", kTerrain, {"energy.profile=n45"}, {"9"}},
  };
  for (const CostRow& row : kCostTable)
    rows.push_back(
        {std::string(row.section) + "." + std::string(row.key), kTerrain, {"energy.profile=n45"}, {"12345"}});
  return rows;
}

}  // namespace carousel
