#include "ringbus/stress/violations.h"

#include <fmt/format.h>

namespace carousel::ringbus::stress {

std::string Violations::names() const {
  std::string text;
  const auto add = [&](const char* name, std::uint64_t count) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  };
  add("lost", lost);
  add("doubled", doubled);
  add("reordered", reordered);
  add("torn", corrupted);
  add("bounds", bounds);
  if (stuck) text += text.empty() ? "stuck" : ", stuck";
  return text;
}

Violations& Violations::operator+=(const Violations& o) {
  lost += o.lost;
  doubled += o.doubled;
  reordered += o.reordered;
  corrupted += o.corrupted;
  bounds += o.bounds;
  stuck |= o.stuck;
  if (detail.empty()) detail = o.detail;
  return *this;
}

}  // namespace carousel::ringbus::stress
