#include "app/run/hit_recorder.h"

namespace carousel::app {

std::vector<report::HitRow> HitRecorder::take() {
  std::vector<report::HitRow> all;
  for (Worker& worker : workers_) {
    all.insert(all.end(), worker.rows.begin(), worker.rows.end());
    std::vector<report::HitRow>().swap(worker.rows);
  }
  report::sort_rows(all);
  return all;
}

}  // namespace carousel::app
