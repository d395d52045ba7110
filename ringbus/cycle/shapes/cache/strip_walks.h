#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <vector>

#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A cache's way along strips whose requests name no length (`memory.strip_end: flag`; US 9633468: the address of the
/// first element, a stride, and a flag at the end).
///
/// The flags of a line can be read when the line is there, and are read line by line. While the end has not been found,
/// the next line whose flags are to be read, and `memory.strip_ahead` lines behind it, are looked up. So some lines
/// behind the end may be looked up in vain, and with few lines ahead each line of a strip waits for the one before.
class StripWalks {
 public:
  /// A line that may be looked up now.
  struct Line {
    std::uint64_t line = 0;
    bool past_end = false;
  };

  explicit StripWalks(std::uint64_t ahead) : ahead_(ahead) {}

  /// A strip of `lines` lines is asked for, by `request`. Returns its number.
  std::uint32_t begin(std::uint64_t first_line, std::uint32_t lines, std::uint32_t request);
  std::uint32_t request(std::uint32_t walk) const { return walks_[walk].request; }
  /// The next line, if one may be looked up; it then has been.
  std::optional<Line> next_line(std::uint32_t walk);
  /// A line of the strip will be there `at` this time, or is.
  void there(std::uint32_t walk, std::uint64_t line, Cycle at) { events_.push({at, turn_++, walk, line}); }

  /// The time at which the next line is there.
  Cycle next() const { return events_.empty() ? kNever : events_.top().at; }
  /// Takes the line that is there at next(). Returns its walk if more lines of it may be looked up now. A walk whose
  /// end has been found is over.
  std::optional<std::uint32_t> take();

 private:
  struct Walk {
    std::uint64_t first_line = 0;
    std::uint32_t lines = 0, request = 0;
    std::uint64_t looked_up = 0, read = 0;  // lines; of those that are there the first ones have been read
    std::vector<bool> here;
  };
  struct Event {
    Cycle at = 0;
    std::uint64_t turn = 0;
    std::uint32_t walk = 0;
    std::uint64_t line = 0;
    bool operator>(const Event& o) const { return at != o.at ? at > o.at : turn > o.turn; }
  };

  std::uint64_t ahead_;
  std::vector<Walk> walks_;
  std::vector<std::uint32_t> free_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t turn_ = 0;
};

}  // namespace carousel::ringbus::cycle
