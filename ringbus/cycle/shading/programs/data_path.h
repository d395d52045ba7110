#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <queue>
#include <vector>

#include "core/config/fields/shading.h"
#include "core/statistics/shading_counts.h"
#include "ringbus/cycle/memory/translator.h"
#include "ringbus/cycle/shading/programs/program_memory.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The way of a shader worker's reads to memory: its TLB (`shading.translation`) and its data cache
/// (`shading.data_cache`), of which either may be missing.
///
/// - The worker sends a line a cycle, and its page is looked up in that cycle. Without it the line waits for the walker
///   (Translator). Lines that have waited go on one a cycle, by the same port.
/// - The line is then in the cache or not; either is known `latency_cycles` later. A line that was there is the answer.
///   Another one is asked for then, and put in place of that of its set that was used least recently when it comes. A
///   line that is under way is not asked for again; it is the answer when it has come, and that is known.
class DataPath final : public ProgramMemory {
 public:
  /// Keeps a reference to the memory.
  DataPath(const DataCacheConfig& cache, const TranslationConfig& pages, std::uint32_t worker, ProgramMemory& memory);

  std::uint64_t line_bytes() const override { return line_bytes_; }
  /// `data` is a line.
  void read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) override;
  /// An answer to this path has come.
  void take(const ProgramRead& read, Cycle now);
  Cycle next() const { return events_.empty() ? kNever : events_.top().at; }
  /// Does what is due; calls on_answer(by) for each read of the worker whose data is there.
  template <class OnAnswer>
  void step(Cycle now, OnAnswer&& on_answer) {
    while (next() <= now) {
      const Event event = events_.top();
      events_.pop();
      if (event.what == What::kAnswer) {
        on_answer(lines_[event.line].by);
        free_.push_back(event.line);
      } else if (event.what == What::kPage) {
        look_up_page(event.line, now);
      } else if (event.what == What::kLine) {
        look_up_line(event.line, now);
      } else {
        ask(event.line, now);
      }
    }
  }
  const ShadeDataCounts& counts() const { return counts_; }

 private:
  /// A line on its way to the worker.
  struct Line {
    ShadeData what;
    std::uint64_t offset, address;  // in its table, and in the simulated memory
    ProgramRead by;
    Cycle known = 0;  // if the cache has it
  };
  enum class What : std::uint8_t { kPage, kLine, kAsk, kAnswer };
  struct Event {
    Cycle at;
    std::uint64_t order;
    What what;
    std::uint32_t line;
    bool operator>(const Event& o) const { return at != o.at ? at > o.at : order > o.order; }
  };
  /// What a set of the cache holds, that used last at the end.
  using Names = std::vector<std::uint64_t>;

  std::uint32_t begin(const Line& line);
  void due(Cycle at, What what, std::uint32_t line) { events_.push({at, ++order_, what, line}); }
  void look_up_page(std::uint32_t line, Cycle now);
  void look_up_line(std::uint32_t line, Cycle now);
  void ask(std::uint32_t line, Cycle now);
  void read_entry(Cycle now);
  Cycle take_port(Cycle now);
  static bool use(Names& names, std::uint64_t name);
  static void put(Names& names, std::size_t most, std::uint64_t name);
  Names& set_of(std::uint64_t address) { return sets_[address / line_bytes_ % sets_.size()]; }

  ProgramMemory& memory_;
  std::uint32_t worker_;
  std::uint64_t line_bytes_;
  std::size_t ways_;
  Cycle latency_;
  Translator<std::uint32_t> pages_;  // of lines
  std::vector<Names> sets_;          // of the cache; none: there is no cache
  std::vector<Line> lines_;
  std::vector<std::uint32_t> free_;                             // unused places in lines_
  std::map<std::uint64_t, std::vector<std::uint32_t>> coming_;  // lines that wait, by address
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t order_ = 0;
  Cycle port_free_ = 0;
  ShadeDataCounts counts_;
};

}  // namespace carousel::ringbus::cycle
