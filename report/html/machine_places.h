#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// A place in a drawing, in units of its own: x to the right, y downwards.
struct Place {
  double x = 0, y = 0;
};

/// The drawing of a machine: the places of its resources and, behind them, of its hubs (bridges, routers, the bus); and
/// the links between them, by these numbers.
struct MachinePlaces {
  std::size_t resources = 0;
  std::vector<Place> at{};
  std::vector<std::pair<std::size_t, std::size_t>> links{};

  /// The least distance between two of them; 1 if there is one.
  double least_gap() const;
};

/// Places by the shape of the network in the report's configuration, or as a drawn network gives them. Boxes of half
/// the least gap do not lie over one another.
MachinePlaces machine_places(const nlohmann::ordered_json& report);

}  // namespace carousel::report::html
