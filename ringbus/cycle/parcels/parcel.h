#pragma once

#include <cstdint>
#include <variant>

#include "core/config/fields/graph.h"
#include "ringbus/cycle/messages/control_messages.h"
#include "ringbus/cycle/messages/memory_messages.h"

namespace carousel::ringbus::cycle {

/// A line that a cache asks for, writes or gets.
struct LineMessage {
  std::uint64_t line = 0;  ///< with kWriteLine and kWholeLine
};

/// A message on drawn links, with its way. Where it goes follows from what it is about, the address of a line or the
/// number of a ray, so the way has no bytes of its own.
struct Parcel {
  using Body = std::variant<LineMessage, FetchRequest, FetchAnswer, NewRays, CompletedRays>;

  Body body{};
  Carried what = Carried::kShapes;
  std::uint32_t stop = 0;  ///< node of the graph
  std::uint32_t door = 0;  ///< there
  std::uint64_t size_bytes = 0;
  bool through = false;  ///< the next node sends it on as soon as its head has come

  std::uint64_t bytes() const { return size_bytes; }
};

}  // namespace carousel::ringbus::cycle
