#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// A node of a network that is drawn (topology.shape: graph). Its place in the list is its number.
struct DrawnNode {
  std::string name;
  std::optional<double> x_mm{}, y_mm{};
};

template <class V>
void describe(V& v, const DrawnNode& r) {
  v.field("name", r.name, "", "its name, as topology.links has it");
  v.field("x_mm", r.x_mm, "mm", "its place on the die, if it has one");
  v.field("y_mm", r.y_mm, "mm", "likewise");
}

}  // namespace carousel::report
