#include "ringbus/stress/violations.h"

#include <fmt/format.h>

namespace carousel::ringbus::stress {

std::string Findings::names() const {
  std::string text;
  const auto add = [&](const char* name, std::uint64_t count) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  };
  add("lost", lost);
  add("doubled", doubled);
  add("reordered", reordered);
  add("torn", torn);
  add("bounds", bounds);
  if (stuck) text += text.empty() ? "stuck" : ", stuck";
  return text;
}

Findings& Findings::operator+=(const Findings& o) {
  lost += o.lost;
  doubled += o.doubled;
  reordered += o.reordered;
  torn += o.torn;
  bounds += o.bounds;
  stuck |= o.stuck;
  if (detail.empty()) detail = o.detail;
  return *this;
}

}  // namespace carousel::ringbus::stress
