#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/sweep/process/scene_host.h"

namespace carousel::app {

/// Runs points in processes, as many at once as it is told: a host a group of points that share scene and acceleration
/// structure (SceneHost), and a process a point below it. One thread.
class WorkerPool {
 public:
  /// A point that is over. Its file is written, unless there is an error other than a failed verification.
  struct Finished {
    SweepPoint point;
    double seconds = 0;
    std::optional<PointError> error;
  };

  WorkerPool(const SweepSetup& setup, std::size_t jobs) : setup_(setup), jobs_(jobs) {}
  /// Ends what runs.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void add(SweepPoint point);
  bool busy() const { return waiting_count_ > 0 || running_count_ > 0; }
  std::size_t running() const { return running_count_; }

  /// Starts what there is room for, and waits until something is over, `also` can be read (if it is not negative), or
  /// the time has passed. `started` is called for each point that starts. Throws FileError.
  template <class Started>
  std::vector<Finished> step(int timeout_ms, int also, const Started& started) {
    for (const std::uint64_t id : start_more()) started(points_.at(id));
    return wait(timeout_ms, also);
  }

 private:
  struct Host {
    SceneHost process;
    std::string group;
    bool ready = false;
    std::vector<std::uint64_t> running;
  };

  std::vector<std::uint64_t> start_more();
  std::optional<std::uint64_t> start_one();
  Host* choose_host();
  Host& start_host(const std::string& group);
  void end_host(std::size_t index);
  void end_idle_hosts();
  std::vector<Finished> wait(int timeout_ms, int also);
  void on_worker(std::size_t index, std::vector<Finished>& out);
  void host_ended(std::size_t index, std::vector<Finished>& out);
  Finished finish(std::uint64_t id, double seconds, std::optional<PointError> error);
  std::size_t slots(const SweepPoint& point) const;

  SweepSetup setup_;
  std::size_t jobs_, used_ = 0, waiting_count_ = 0, running_count_ = 0;
  std::uint64_t next_id_ = 0;
  std::map<std::uint64_t, SweepPoint> points_;                ///< that wait or run
  std::vector<std::string> groups_;                           ///< with waiting points, in the order of their coming
  std::map<std::string, std::deque<std::uint64_t>> waiting_;  ///< by group
  std::vector<Host> hosts_;
};

}  // namespace carousel::app
