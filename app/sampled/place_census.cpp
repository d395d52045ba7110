#include "app/sampled/place_census.h"

namespace carousel::app {

PlaceCensus::PlaceCensus(Workload& inner, const RenderJob& job)
    : WrappedWorkload(inner), job_(job), place_of_(job.pieces()) {
  for (const shading::PathSample::Run& run : job.sample()->runs()) {
    place_of_[job.piece_at(run.first)] = run.place;
    if (paths_.size() <= run.place) paths_.resize(run.place + std::size_t{1});
    paths_[run.place] += run.count;
  }
  rays_.resize(paths_.size());
}

}  // namespace carousel::app
