#include "ringbus/time/windows.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "ringbus/rays/ray_id.h"
#include "ringbus/time/faster_way.h"

namespace carousel::ringbus {

namespace {

/// Makes threads wait for each other, twice a window. If there is a core for each, a thread spins for about as long as
/// waking a sleeper takes, and then sleeps: a thread that is woken runs soon even on a busy machine, while one that
/// yields goes behind all others. Spinning in vain on a busy machine takes the core from the very thread that is waited
/// for, so a thread that had to sleep spins for half as long the next time.
class Barrier {
 public:
  explicit Barrier(std::size_t threads) : threads_(threads), spins_(threads <= std::thread::hardware_concurrency()) {}

  /// `patience` is the caller's own, kept from one wait to the next.
  struct Patience {
    std::chrono::nanoseconds spin = kLongest;
  };

  void wait(Patience& patience) {
    const std::size_t turn = turn_.load(std::memory_order_relaxed);
    // Acquire and release: a thread that leaves sees everything that all did before they arrived.
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      turn_.store(turn + 1, std::memory_order_release);
      turn_.notify_all();
      return;
    }
    if (spins_ && spun(turn, patience.spin)) {
      patience.spin = std::min(kLongest, patience.spin * 2);
      return;
    }
    patience.spin = std::max(kShortest, patience.spin / 2);
    while (turn_.load(std::memory_order_acquire) == turn) turn_.wait(turn, std::memory_order_acquire);
  }

 private:
  static constexpr std::chrono::nanoseconds kLongest = std::chrono::microseconds(100),
                                            kShortest = std::chrono::microseconds(1);

  /// Spins, and returns whether the turn ended meanwhile.
  bool spun(std::size_t turn, std::chrono::nanoseconds at_most) const {
    const auto end = std::chrono::steady_clock::now() + at_most;
    do {
      for (int looks = 0; looks < 64; ++looks)
        if (turn_.load(std::memory_order_acquire) != turn) return true;
    } while (std::chrono::steady_clock::now() < end);
    return false;
  }

  std::size_t threads_;
  bool spins_;
  alignas(64) std::atomic<std::size_t> arrived_{0};
  alignas(64) std::atomic<std::size_t> turn_{0};
};

class WindowRun {
 public:
  WindowRun(std::span<const std::vector<Agent*>> parts, WakeupTable& wakeups, Cycle lookahead, Sharing sharing,
            const std::function<bool(Cycle)>& keep_running, const std::function<Cycle(Cycle)>& look, Cycle first_look)
      : parts_(parts),
        wakeups_(wakeups),
        lookahead_(lookahead),
        sharing_(sharing),
        keep_running_(keep_running),
        look_(look),
        next_look_(first_look),
        barrier_(parts.size()),
        next_(parts.size()),
        schedules_(parts.begin(), parts.end()) {}

  Cycle run() {
    {
      std::vector<std::jthread> threads;
      try {
        for (std::size_t t = 1; t < parts_.size(); ++t) threads.emplace_back([this, t] { work_when_all_are_there(t); });
      } catch (...) {  // no further thread can be started: the barrier would wait for it
        begin(Start::kNever);
        throw;
      }
      begin(Start::kNow);
      work(0);
    }
    if (error_) std::rethrow_exception(error_);
    return reached_;
  }

 private:
  struct alignas(64) Next {
    Cycle cycle = kNever;
    std::uint64_t runs = 0;  // runs of the thread's agents since the last look at how much they do
  };

  enum class Start { kNotYet, kNow, kNever };

  void begin(Start start) {
    start_.store(start, std::memory_order_release);
    start_.notify_all();
  }

  void work_when_all_are_there(std::size_t thread) {
    start_.wait(Start::kNotYet, std::memory_order_acquire);
    if (start_.load(std::memory_order_acquire) == Start::kNow) work(thread);
  }

  void work(std::size_t thread) {
    const std::vector<Agent*>& agents = parts_[thread];
    Schedule& schedule = schedules_[thread];
    const bool alone = parts_.size() == 1;
    Barrier::Patience patience;
    for (std::uint64_t window = 0;; ++window) {
      if (!alone && window > 0 && window % kPollInterval == 0 && (slower_together_ || has_little_work())) {
        if (thread == 0) run_alone();  // all threads agree
        barrier_.wait(patience);
      }
      Cycle first = look(thread, schedule);
      // Written before the last barrier, so all threads read the same here.
      const bool stop = stop_.load(std::memory_order_relaxed);
      if (!alone) {
        next_[thread].cycle = first;
        barrier_.wait(patience);
        for (const Next& other : next_) first = std::min(first, other.cycle);
      }
      if (first == kNever || stop) {  // all threads come to the same conclusion
        if (kChecked && !stop) check_at_rest(agents);
        break;
      }
      if (window % kPollInterval == 0) {
        if (thread == 0 && !keep_running_(first)) stop_.store(true, std::memory_order_relaxed);
        next_[thread].runs = 0;
        if (thread == 0) began_ = now();
        if (!alone) barrier_.wait(patience);
      }
      const Cycle end = first + lookahead_;
      for (Cycle from = first;;) {  // all threads agree on next_look_, which is written between two barriers
        if (next_look_ <= from) {
          if (!alone) barrier_.wait(patience);
          if (thread == 0) look_until(from);
          if (!alone) barrier_.wait(patience);
        }
        const Cycle to = end_of_part(end);
        next_[thread].runs += run_window(agents, schedule, from, to);
        if (to == end) break;
        poll(agents, schedule);
        from = to;
      }
      if (thread == 0) reached_ = first;
      if (thread == 0 && sharing_ == Sharing::kWhenFaster && (window + 1) % kPollInterval == 0)
        slower_together_ = way_.alone_after_together(next_[0].runs, now() - began_, now());
      if (!alone) barrier_.wait(patience);
    }
  }

  static FasterWay::Time now() { return std::chrono::steady_clock::now().time_since_epoch(); }

  /// Waiting for each other takes the threads longer than the few agents that run in a window.
  bool has_little_work() const {
    std::uint64_t runs = 0;
    for (const Next& one : next_) runs += one.runs;
    return runs < kLeastRuns * parts_.size() * kPollInterval;
  }

  /// The calling thread runs the agents of all threads, which wait, until that is slower, or an end.
  void run_alone() {
    bool slower_together = slower_together_;  // which others may not have read yet
    FasterWay::Time began = now();
    for (std::uint64_t window = 0, runs = 0, own = 0;; ++window) {
      if (window == kPollInterval) {
        if (slower_together) slower_together = way_.alone_after_alone(own, now() - began, now());
        if (!slower_together && runs >= 2 * kLeastRuns * parts_.size() * kPollInterval) return;
        window = runs = own = 0;
        began = now();
      }
      Cycle first = kNever;
      for (std::size_t t = 0; t < parts_.size(); ++t) first = std::min(first, look(t, schedules_[t]));
      if (first == kNever || stop_.load(std::memory_order_relaxed)) return;
      if (window == 0 && !keep_running_(first)) return stop_.store(true, std::memory_order_relaxed);
      for (Cycle from = first, end = first + lookahead_; from < end;) {
        look_until(from);
        const Cycle to = end_of_part(end);
        for (std::size_t t = 0; t < parts_.size(); ++t) {
          const std::uint64_t done = run_window(parts_[t], schedules_[t], from, to);
          runs += done;
          if (t == 0) own += done;
          if (to < end) poll(parts_[t], schedules_[t]);
        }
        from = to;
      }
      reached_ = first;
    }
  }

  /// The end of the part of a window that may be run before the next look.
  Cycle end_of_part(Cycle end) const { return std::min(end, next_look_); }
  /// Nothing happens before `now` any more. A look that throws ends the run as an agent does: other threads wait at a
  /// barrier, which this one must not leave them at.
  void look_until(Cycle now) {
    try {
      while (next_look_ <= now) next_look_ = look_(next_look_);
    } catch (...) {
      keep_error();
      next_look_ = kNever;
    }
  }

  /// By agent of a thread: the time at which it is next to run, and whether it must be asked before every window.
  struct Schedule {
    std::vector<Cycle> wake;
    std::vector<std::uint8_t> polled;
    std::vector<ClockRatio> clocks;  // empty: all go by one

    explicit Schedule(const std::vector<Agent*>& agents) {
      for (const Agent* agent : agents) {
        wake.push_back(agent->next());
        polled.push_back(agent->polled());
      }
      if (std::any_of(agents.begin(), agents.end(), [](const Agent* agent) { return !agent->clock().equal(); }))
        for (const Agent* agent : agents) clocks.push_back(agent->clock());
    }
    /// The cycle of the fastest clock in which an edge of an agent's lies.
    Cycle cycle_of(std::size_t i, Cycle edge) const {
      if (clocks.empty() || edge == kNever) return edge;
      return clocks[i].floor_to_network(edge);
    }
    /// The first edge of an agent's clock that is not before a cycle of the fastest one.
    Cycle edge_at(std::size_t i, Cycle cycle) const { return clocks.empty() ? cycle : clocks[i].to_core(cycle); }
  };

  /// Within a window, after a part of it: what agents have left out of next_after_run().
  static void poll(const std::vector<Agent*>& agents, Schedule& schedule) {
    for (std::size_t i = 0; i < agents.size(); ++i)
      if (schedule.polled[i]) schedule.wake[i] = std::min(schedule.wake[i], agents[i]->unannounced());
  }

  /// Takes in the announcements, between windows. Returns the earliest time at which an agent of the thread has to run.
  Cycle look(std::size_t thread, Schedule& schedule) {
    // Spans, since a call of an agent may change a vector for all that the compiler knows.
    const std::span<Agent* const> agents = parts_[thread];
    const std::span<Cycle> wake = schedule.wake;
    for (std::size_t from = 0; from < parts_.size(); ++from) {
      take_beside(wakeups_.row_beside(thread, from), wake, agents);
      if (from + 1 < parts_.size()) take_announcements(wakeups_.row(thread, from), wake);
    }
    // The last row is taken in on the way through all agents.
    const std::span<Cycle> row = wakeups_.row(thread, parts_.size() - 1);
    const std::span<const std::uint8_t> polled = schedule.polled;
    const bool one_clock = schedule.clocks.empty();
    Cycle first = kNever;
    for (std::size_t i = 0; i < wake.size(); ++i) {
      Cycle at = std::min(wake[i], std::exchange(row[i], kNever));
      if (polled[i]) at = std::min(at, agents[i]->unannounced());
      wake[i] = at;
      first = std::min(first, one_clock ? at : schedule.cycle_of(i, at));
    }
    return first;
  }
  static void take_announcements(std::span<Cycle> row, std::span<Cycle> wake) {
    for (std::size_t i = 0; i < row.size(); ++i) wake[i] = std::min(wake[i], std::exchange(row[i], kNever));
  }
  /// `row` may be empty: nothing is announced there.
  static void take_beside(std::span<Cycle> row, std::span<Cycle> wake, std::span<Agent* const> agents) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i] == kNever) continue;
      agents[i]->notify(row[i]);
      wake[i] = std::min(wake[i], std::exchange(row[i], kNever));
    }
  }

  // An agent's work waits until the agent runs. An agent that was not woken in time therefore has work from before the
  // window when it runs at last, or still has work at the end. Checked builds look at these two points only.
  [[noreturn]] static void throw_not_woken() { throw std::logic_error("an agent was not woken"); }

  void check_at_rest(const std::vector<Agent*>& agents) {
    try {
      for (const Agent* agent : agents)
        if (agent->next() != kNever) throw_not_woken();
    } catch (...) {
      keep_error();
    }
  }

  /// The first one of all threads, from within a handler; no further window begins.
  void keep_error() {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::current_exception();
    stop_.store(true, std::memory_order_relaxed);
  }

  /// Returns how many agents had something to do.
  std::uint64_t run_window(std::span<Agent* const> agents, Schedule& schedule, Cycle begin, Cycle end) {
    std::uint64_t runs = 0;
    const bool one_clock = schedule.clocks.empty();
    const std::span<Cycle> wake = schedule.wake;
    try {
      for (std::size_t i = 0; i < agents.size(); ++i) {
        const Cycle own_end = one_clock ? end : schedule.edge_at(i, end);
        if (wake[i] >= own_end) continue;
        if (kChecked && agents[i]->next() < schedule.edge_at(i, begin)) throw_not_woken();
        ++runs;
        agents[i]->run(own_end);
        wake[i] = agents[i]->next_after_run();
        schedule.polled[i] = agents[i]->polled();
      }
    } catch (...) {
      keep_error();
    }
    return runs;
  }

  static constexpr std::uint64_t kPollInterval = 64;
  static constexpr std::uint64_t kLeastRuns = 8;  // runs in a window, a thread; fewer are not worth two barriers

  std::span<const std::vector<Agent*>> parts_;
  WakeupTable& wakeups_;
  Cycle lookahead_;
  Sharing sharing_;
  const std::function<bool(Cycle)>& keep_running_;
  const std::function<Cycle(Cycle)>& look_;
  Cycle next_look_;  // written by thread 0 while no agent runs
  // Of thread 0, which writes slower_together_ before a barrier; the others read it after that.
  FasterWay way_;
  FasterWay::Time began_{0};
  bool slower_together_ = false;
  Barrier barrier_;
  std::vector<Next> next_;
  std::vector<Schedule> schedules_;  // by thread
  std::atomic<Start> start_{Start::kNotYet};
  std::atomic<bool> stop_{false};
  Cycle reached_ = 0;
  std::mutex mutex_;  // guards error_
  std::exception_ptr error_;
};

}  // namespace

Cycle run_windows(std::span<const std::vector<Agent*>> parts, WakeupTable& wakeups, Cycle lookahead, Sharing sharing,
                  const std::function<bool(Cycle)>& keep_running, const std::function<Cycle(Cycle)>& look,
                  Cycle first_look) {
  return WindowRun(parts, wakeups, lookahead, sharing, keep_running, look, first_look).run();
}

}  // namespace carousel::ringbus
