#pragma once

#include <cstdint>

#include "core/types/shade_facts.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Names the read of a program: when its data comes, the register is filled.
struct ProgramRead {
  std::uint32_t worker = 0, vector = 0;
  std::uint8_t reg = 0;
};

/// Where programs read materials, vertices and texels.
class ProgramMemory {
 public:
  virtual ~ProgramMemory() = default;
  virtual std::uint64_t line_bytes() const = 0;
  /// Asks for data, which has come when ShadeCore::answer() is called.
  virtual void read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) = 0;
};

}  // namespace carousel::ringbus::cycle
