#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "ringbus/cycle/parcels/door.h"
#include "ringbus/cycle/parcels/line_turns.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// One of the nodes that hold lines in turn.
struct LineBank {
  LineTurns turns;
  std::uint64_t node = 0;

  std::uint64_t global(std::uint64_t local) const { return turns.global(node, local); }
};

/// The channels between one that asks for lines, one by one, and one that holds them.
struct LineEnds {
  Channel<std::uint64_t>* requests = nullptr;  ///< line numbers, with kWriteLine and kWholeLine
  Channel<std::uint64_t>* answers = nullptr;
};

/// The way of a cache to those from which it gets its lines: of an L2 to the memories, of a resource's own cache to the
/// L2s.
class AskDoor final : public Door {
 public:
  /// `own`: the bank that asks, by whose numbers it names lines. `banks`: the doors of those that `turns` names.
  AskDoor(const LineEnds& ends, const LineBank& own, const LineTurns& turns, std::vector<DoorPlace> banks,
          std::uint64_t line_bytes)
      : ends_(ends), own_(own), turns_(turns), banks_(std::move(banks)), line_bytes_(line_bytes) {}

  Cycle next() const override { return ends_.requests->next(); }
  void collect(Cycle now, std::vector<Parcel>& out) override;
  void deliver(Parcel&& parcel, Cycle now) override;

 private:
  LineEnds ends_;
  LineBank own_;
  LineTurns turns_;
  std::vector<DoorPlace> banks_;
  std::uint64_t line_bytes_;
};

/// The way of a memory, or of an L2, back to one cache that asks it. On links, answers have the numbers that all use.
class AnswerDoor final : public Door {
 public:
  AnswerDoor(const LineEnds& ends, const LineBank& own, DoorPlace asker, std::uint64_t line_bytes)
      : ends_(ends), own_(own), asker_(asker), line_bytes_(line_bytes) {}

  Cycle next() const override { return ends_.answers->next(); }
  void collect(Cycle now, std::vector<Parcel>& out) override;
  void deliver(Parcel&& parcel, Cycle now) override;

 private:
  LineEnds ends_;
  LineBank own_;
  DoorPlace asker_;
  std::uint64_t line_bytes_;
};

}  // namespace carousel::ringbus::cycle
