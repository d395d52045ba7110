#pragma once

#include "core/types/enum_names.h"

namespace carousel {

enum class EngineKind { kNative, kCycle };
template <>
inline constexpr auto kEnumNames<EngineKind> = [] {
  using enum EngineKind;
  return names<EngineKind>({{kNative, "native"}, {kCycle, "cycle"}});
}();

}  // namespace carousel
