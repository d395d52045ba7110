#include "ringbus/stress/worker_group.h"

#include <algorithm>
#include <thread>

#include <sched.h>

namespace carousel::ringbus::stress {

namespace {

/// Pins the thread to a core, if the system allows: the scheduler tends to put threads that talk to each other on one
/// core, where they only take turns.
void stay_on_core(std::size_t thread) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
  std::vector<int> cores;
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &allowed)) cores.push_back(core);
  if (cores.empty()) return;
  cpu_set_t mine;
  CPU_ZERO(&mine);
  CPU_SET(cores[thread % cores.size()], &mine);
  (void)sched_setaffinity(0, sizeof mine, &mine);
}

}  // namespace

void pause_for(std::chrono::nanoseconds time) {
  if (time >= std::chrono::microseconds(50)) return std::this_thread::sleep_for(time);
  const Clock::time_point until = Clock::now() + time;
  do std::this_thread::yield();
  while (Clock::now() < until);
}

std::uint64_t WorkerGroup::steps() const {
  std::uint64_t sum = 0;
  for (const Progress& one : progress_) sum += one.steps.load(std::memory_order_relaxed);
  return sum;
}

WorkerGroup::Ending WorkerGroup::run(const std::shared_ptr<WorkerGroup>& group,
                                     const std::vector<std::function<void()>>& bodies, const Limits& limits) {
  std::vector<std::thread> threads;
  for (const std::function<void()>& body : bodies)
    threads.emplace_back([group, body, t = threads.size(), all = bodies.size()] {
      stay_on_core(t);
      {
        std::unique_lock lock(group->mutex_);
        if (++group->ready_ == all) group->changed_.notify_all();
        group->changed_.wait(lock, [&] { return group->ready_ == all; });
      }
      body();
      const std::lock_guard lock(group->mutex_);
      ++group->ended_;
      group->changed_.notify_all();
    });

  std::unique_lock lock(group->mutex_);
  group->changed_.wait(lock, [&] { return group->ready_ == bodies.size(); });
  const Clock::time_point deadline = Clock::now() + limits.time;
  Clock::time_point last_change = Clock::now();
  std::uint64_t last = 0;
  bool stuck = false;
  const auto all_ended = [&] { return group->ended_ == bodies.size(); };
  while (!all_ended()) {
    const Clock::time_point now = Clock::now();
    const auto step = std::min<std::chrono::nanoseconds>(std::chrono::milliseconds(20), limits.stuck_after / 4);
    const Clock::time_point wake = group->stop_sending() ? now + step : std::min(deadline, now + step);
    group->changed_.wait_until(lock, wake, all_ended);
    if (Clock::now() >= deadline || limits.stop.stop_requested()) group->stop_sending_ = true;
    if (const std::uint64_t steps = group->steps(); steps != last) {
      last = steps;
      last_change = Clock::now();
      continue;
    }
    if (Clock::now() - last_change < limits.stuck_after) continue;
    if (stuck) break;  // they were asked to return and have not
    stuck = true;
    group->end_ = true;
    last_change = Clock::now();
  }
  const bool returned = all_ended();
  lock.unlock();
  for (std::thread& thread : threads)
    if (returned)
      thread.join();
    else
      thread.detach();
  return !returned ? Ending::kNeverReturned : stuck ? Ending::kStuck : Ending::kDone;
}

}  // namespace carousel::ringbus::stress
