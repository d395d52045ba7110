#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <stop_token>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/config/fields/image.h"
#include "core/config/fields/memory.h"
#include "core/statistics/cache_counts.h"
#include "core/statistics/memory_counts.h"
#include "ringbus/cycle/builder/builder_work.h"
#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/results/dram_use.h"
#include "ringbus/time/agent.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// The work of the builder for one frame.
struct BuilderUse {
  bool complete = true;
  Cycle cycles = 0;  ///< until all that it wrote is in memory
  std::uint64_t levels = 0, boxes = 0;
  std::uint64_t lines_read = 0, lines_written = 0, top_lines = 0;
  MemoryCounts memory{};            ///< what the memory has moved for it
  std::optional<CacheCounts> l2{};  ///< with frames.builder.asks: l2
  std::optional<DramUse> dram{};    ///< with banks
};

/// The unit that builds: it asks the memory for lines, adds up boxes and writes lines, level by level. It has a port of
/// so many bytes a cycle for all lines, a pipeline of so many boxes a cycle with a latency, and no cache: each task
/// asks for each of its lines once. A line that it writes leaves when the task's boxes are done, and what the next
/// level reads comes to the memory behind it.
class BuilderUnit final : public Agent {
 public:
  /// Requests are so long on their way to the memory or the L2.
  BuilderUnit(const BuilderConfig& config, const MemoryConfig& memory, const BuilderWork& work, Cycle latency,
              Channel<std::uint64_t>& requests, Channel<std::uint64_t>& answers);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override { return done() ? "" : "the builder waits for lines"; }

  bool done() const { return level_ == work_.levels.size(); }
  Cycle last_step() const { return now_; }
  const BuilderUse& use() const { return use_; }

 private:
  struct Computed {
    Cycle at = 0;
    std::size_t task = 0;
  };

  void begin_level();
  void step(Cycle now);
  void take_answer(std::uint64_t line);
  void compute(std::size_t task);
  bool may_send() const;
  void send(std::uint64_t request);
  std::vector<std::uint64_t> lines_of(const std::vector<ShapeSpan>& spans) const;
  std::vector<std::uint64_t> writes_of(const BuilderTask& task) const;
  const BuilderTask& task(std::size_t number) const { return work_.levels[level_][number]; }

  std::uint64_t port_rate_, box_rate_, line_bytes_;
  bool asks_l2_;
  std::size_t most_requests_;
  Cycle box_latency_, latency_;  // of the pipeline, and of requests on their way
  const BuilderWork& work_;
  Channel<std::uint64_t>&requests_, &answers_;

  std::size_t level_ = 0, next_task_ = 0, written_tasks_ = 0;         // of the level
  std::deque<std::uint64_t> to_read_, to_write_;                      // lines of tasks that have been begun
  std::vector<std::size_t> waits_;                                    // by task of the level: lines that it waits for
  std::unordered_map<std::uint64_t, std::deque<std::size_t>> asked_;  // by line: tasks in the order of their requests
  std::deque<Computed> computed_;
  std::size_t under_way_ = 0;
  std::uint64_t port_ = 0, boxes_ = 0;  // the port and the pipeline are taken up to this byte and box of time
  Cycle now_ = 0;
  BuilderUse use_;
};

/// Does the work alone with a memory of the machine, one if it has several; with `asks: l2` through an L2 before it
/// that holds the lines of `cached`, oldest first, and at the end others. Those that it wrote are then in the memory;
/// if it was stopped the L2 holds none. Throws SimulationError if its counts, and those of the L2 and the memory,
/// differ.
BuilderUse run_builder(const BuilderConfig& config, const MemoryConfig& memory, std::int64_t clock_mhz,
                       const BuilderWork& work, const std::stop_token& stop, std::vector<std::uint64_t>& cached);

}  // namespace carousel::ringbus::cycle
