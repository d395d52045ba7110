#include "bench/rays/measure.h"

#include <bit>

#include <fmt/format.h>

#include "core/numeric/digest.h"

namespace carousel::bench {

namespace {

/// A contestant that takes longer is run once.
constexpr double kLongRunSeconds = 5;

bool same(const Hit& a, const Hit& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return a.instance == b.instance && a.primitive == b.primitive && bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) &&
         bits(a.v) == bits(b.v);
}

std::string digest(const RaySet& rays, const HitList& hits) {
  HitsDigest sum;
  for (std::size_t i = 0; i < hits.size(); ++i)
    sum.add(hit_term(static_cast<std::uint32_t>(i), 0, rays[i].tag, hits[i]));
  return sum.hex();
}

std::uint64_t count_hits(const HitList& hits) {
  std::uint64_t count = 0;
  for (const Hit& hit : hits) count += hit.valid();
  return count;
}

/// One contestant and one number of threads, with the times of its runs so far.
struct Entry {
  const Contestant* contestant;
  Measurement measurement;
  std::vector<double> wall, cpu;
  bool longsome = false;
};

class SetMeasurement {
 public:
  SetMeasurement(const accel::Accel& accel, const RaySet& rays)
      : rays_(rays), reference_(reference_hits(accel, rays)), hits_(rays.size) {}

  void run(Entry& entry) {
    // A contestant that loses a ray must not find the last one's answer in its place.
    hits_.assign(rays_.size, Hit{-1, 0, 0, 0, 0});
    const Stopwatch stopwatch;
    entry.measurement.work = entry.contestant->trace(rays_, entry.measurement.threads, hits_);
    const Elapsed elapsed = stopwatch.elapsed();
    const std::uint64_t given_up = entry.measurement.work.given_up_after;
    const double million_rays = 1e-6 * static_cast<double>(given_up > 0 ? given_up : rays_.size);
    entry.wall.push_back(million_rays / elapsed.wall);
    entry.cpu.push_back(million_rays / elapsed.cpu);
    entry.longsome = elapsed.wall > kLongRunSeconds;
    if (given_up == 0) check(entry);
  }

  SetResult result() const {
    SetResult out;
    out.name = rays_.name;
    out.any_hit = rays_.any_hit;
    out.rays = rays_.size;
    out.hits = count_hits(reference_);
    out.digest = digest(rays_, reference_);
    return out;
  }

 private:
  void check(Entry& entry) const {
    const bool ours = entry.contestant->ours;
    Measurement& m = entry.measurement;
    m.hits = count_hits(hits_);
    m.disagreements = 0;
    std::size_t example = 0;
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const bool agree =
          ours && !rays_.any_hit ? same(hits_[i], reference_[i]) : hits_[i].valid() == reference_[i].valid();
      if (agree) continue;
      ++m.disagreements;
      example = i;
    }
    const std::uint64_t allowed = ours ? 0 : rays_.size / 1000 + 2;
    if (m.disagreements <= allowed) return;
    throw WrongHits(
        fmt::format("{} on {} threads, {} rays: {} of {} rays differ from the depth-first tracer, e.g. ray {} (t {} "
                    "instead of {}); "
                    "digest {} instead of {}",
                    m.contestant, m.threads, rays_.name, m.disagreements, rays_.size, example, hits_[example].t,
                    reference_[example].t, digest(rays_, hits_), digest(rays_, reference_)));
  }

  const RaySet& rays_;
  HitList reference_, hits_;
};

}  // namespace

SetResult measure(const std::vector<Contestant>& contestants, const accel::Accel& accel, const RaySet& rays,
                  const MeasureOptions& options) {
  SetMeasurement measurement(accel, rays);
  std::vector<Entry> entries;
  for (const Contestant& contestant : contestants)
    for (const int threads : options.threads)
      entries.push_back({&contestant, {.contestant = contestant.name, .threads = threads}, {}, {}, false});
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      Entry& entry = entries[(i + static_cast<std::size_t>(repetition)) % entries.size()];
      if (entry.longsome) continue;
      if (options.progress)
        options.progress(fmt::format("{} rays, round {} of {}: {}, {} threads", rays.name, repetition + 1,
                                     options.repetitions, entry.contestant->name, entry.measurement.threads));
      measurement.run(entry);
    }
  }
  SetResult result = measurement.result();
  for (Entry& entry : entries) {
    entry.measurement.wall = spread_of(entry.wall);
    entry.measurement.cpu = spread_of(entry.cpu);
    result.measurements.push_back(entry.measurement);
  }
  return result;
}

}  // namespace carousel::bench
