#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "report/csv/ray_csv.h"
#include "shading/tracer/ray_recorder.h"

namespace carousel::app {

/// Keeps every completed ray, for hits.csv and ray files.
class HitRecorder final : public shading::RayRecorder {
 public:
  explicit HitRecorder(std::size_t workers) : workers_(workers) {}

  void record(WorkerId worker, std::uint32_t pixel, std::uint32_t sample, const RayResult& result) override {
    workers_[worker.value].rows.push_back({pixel, sample, result});
  }

  /// All rows, sorted; the recorder is empty afterwards. Call it after the run.
  std::vector<report::HitRow> take();

 private:
  struct alignas(128) Worker {  // a worker writes to its own cache lines
    std::vector<report::HitRow> rows;
  };
  std::vector<Worker> workers_;
};

}  // namespace carousel::app
