#pragma once

#include <cstdint>

#include "core/types/shade_facts.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Names the read of a shader worker. When its data comes, a register of a vector is filled, or a line of the worker's
/// data cache, or its walker goes on, or paths begin at rasterised samples.
struct ProgramRead {
  enum class To : std::uint8_t { kRegister, kCache, kWalker, kCameraRays };

  std::uint32_t worker = 0, vector = 0;  ///< for kCameraRays `vector` is the place of the job
  std::uint8_t reg = 0;
  To to = To::kRegister;
  std::uint64_t address = 0;  ///< of the line, for kCache
};

/// Where programs read materials, vertices and texels, and walkers pages.
class ProgramMemory {
 public:
  virtual ~ProgramMemory() = default;
  virtual std::uint64_t line_bytes() const = 0;
  /// Asks for data, which has come when ShadeCore::answer() is called.
  virtual void read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) = 0;
};

}  // namespace carousel::ringbus::cycle
