#include "ringbus/time/wait_cycle.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

namespace carousel::ringbus {

namespace {

/// The waits from one to itself, or nothing: depth-first, each node entered once.
bool find_circle(const std::vector<Wait>& waits, std::uint32_t at, std::map<std::uint32_t, bool>& open,
                 std::vector<const Wait*>& way) {
  open[at] = true;
  for (const Wait& wait : waits) {
    if (wait.from != at) continue;
    way.push_back(&wait);
    const auto seen = open.find(wait.to);
    if (seen == open.end() ? find_circle(waits, wait.to, open, way) : seen->second) return true;
    way.pop_back();
  }
  open[at] = false;
  return false;
}

}  // namespace

std::string wait_cycle(const std::vector<Wait>& waits) {
  std::map<std::uint32_t, bool> open;  // node: still on the way
  for (const Wait& start : waits) {
    if (open.contains(start.from)) continue;
    std::vector<const Wait*> way;
    if (!find_circle(waits, start.from, open, way)) continue;
    // The way may lead into the circle from outside.
    const auto first = std::find_if(way.begin(), way.end(), [&](const Wait* w) { return w->from == way.back()->to; });
    std::string text = "a circle of waits: ";
    for (auto wait = first; wait != way.end(); ++wait)
      text += fmt::format("resource {} has {} for resource {}{}", (*wait)->from, (*wait)->packet, (*wait)->to,
                          wait + 1 == way.end() ? "" : "; ");
    return text;
  }
  return "";
}

}  // namespace carousel::ringbus
