#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "ringbus/schedule/schedule.h"
#include "tests/ringbus/schedule/fibre.h"

namespace carousel::ringbus {

/// A schedule in which each choice is drawn from a seed. The calling thread is an agent too. A schedule falls into
/// phases of up to some hundred points. In a phase each agent has a weight, and some have none: these rest wherever
/// they are, as threads do that have lost their core. Time goes on by a fixed step a point, of 16 microseconds to
/// 2 milliseconds, so that whatever waits for time ends soon in some schedules and late in others.
///
/// The calling thread follows it while the object lives. One object serves many runs, one after another, which saves
/// making stacks.
class SeededSchedule final : public Schedule {
 public:
  SeededSchedule();
  ~SeededSchedule() override;
  SeededSchedule(const SeededSchedule&) = delete;
  SeededSchedule& operator=(const SeededSchedule&) = delete;

  /// Begins a schedule. No agent of an earlier one may be left.
  void begin(std::uint64_t seed);
  /// Requests the stop of `stop()` after so many more points.
  void stop_in(std::uint64_t points) { stop_at_ = points_ + points; }
  std::stop_token stop() const { return stop_.get_token(); }

  /// Points so far, and a sum over the choices made at them: two schedules with both alike are the same.
  std::uint64_t points() const { return points_; }
  std::uint64_t choices() const { return choices_; }
  /// A number below `most`, drawn from the same seed.
  std::uint64_t draw(std::uint64_t most) { return draw() % most; }

  void start(std::function<void()> agent) override;
  void yield() override;
  Clock::time_point now() override { return now_; }

 private:
  struct Agent {
    std::unique_ptr<Fibre> fibre;
    std::function<void()> body;  // empty: it has none to do
    std::uint32_t weight = 0;
  };

  std::uint64_t draw();
  void begin_phase();
  std::size_t choose();
  void run_agent(std::size_t agent);

  std::vector<Agent> agents_;  // the first is the calling thread
  std::size_t running_ = 0;
  std::uint32_t weights_ = 0;  // their sum
  std::uint64_t state_ = 0, points_ = 0, choices_ = 0, phase_end_ = 0, stop_at_ = 0;
  Clock::duration step_{};
  Clock::time_point now_{};
  std::stop_source stop_;
};

}  // namespace carousel::ringbus
