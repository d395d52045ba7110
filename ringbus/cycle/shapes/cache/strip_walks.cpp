#include "ringbus/cycle/shapes/cache/strip_walks.h"

namespace carousel::ringbus::cycle {

std::uint32_t StripWalks::begin(std::uint64_t first_line, std::uint32_t lines, std::uint32_t request) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(walks_.size()));
    walks_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  Walk& walk = walks_[index];
  walk.first_line = first_line;
  walk.lines = lines;
  walk.request = request;
  walk.looked_up = walk.read = 0;
  walk.here.assign(lines, false);
  return index;
}

std::optional<StripWalks::Line> StripWalks::next_line(std::uint32_t index) {
  Walk& walk = walks_[index];
  if (walk.looked_up > walk.read + ahead_) return {};
  const std::uint64_t line = walk.looked_up++;
  return Line{walk.first_line + line, line >= walk.lines};
}

std::optional<std::uint32_t> StripWalks::take() {
  const Event event = events_.top();
  events_.pop();
  Walk& walk = walks_[event.walk];
  walk.here[event.line - walk.first_line] = true;
  const std::uint64_t before = walk.read;
  while (walk.read < walk.lines && walk.here[walk.read]) ++walk.read;
  if (walk.read == walk.lines) {
    free_.push_back(event.walk);
    return {};
  }
  return walk.read > before ? std::optional(event.walk) : std::nullopt;
}

}  // namespace carousel::ringbus::cycle
