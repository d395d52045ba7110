#include "ringbus/verdict/foretell.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ringbus/verdict/progress_blocks.h"

namespace carousel::ringbus {

namespace {

/// The part of a pilot's deviation that lies in the class at question: with it, 95 % of the gains of machines drawn by
/// `script/verdicts --drawn` lie in their intervals, also where the deviation is great.
constexpr double kInOneClass = 0.75;

/// Standard errors on both sides that hold 95 %, where some ten of 15 differences count as independent (Student's t).
constexpr double kErrorsEachSide = 2.4;

using cycle::CycleResult;
using cycle::ProgressSample;

std::uint64_t drain_begins(const PilotRun& run) {
  return run.result->all_begun ? run.result->all_begun->completed : run.rays;
}

/// The classes of parts whose busy time counts tests: those of box and triangle units that did any.
std::vector<std::size_t> testers(const CycleResult& result) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < result.uses.size(); ++i)
    if ((result.uses[i].name == "box_tests" || result.uses[i].name == "triangle_tests") && result.uses[i].busy > 0)
      out.push_back(i);
  return out;
}

template <class Value>
std::vector<double> means(const CycleResult& result, const std::vector<double>& places, double begin, double end,
                          const Value& value) {
  const auto place = [&](std::size_t i) { return places[i]; };
  return means_of_looks([&](std::uint64_t look) {
    return at_place(result, place, begin + (end - begin) * (2 * static_cast<double>(look) + 1) / (2.0 * kAllLooks),
                    value);
  });
}

/// By how much longer the base takes from each block to the next than the other machine, scaled to the same sum, as a
/// fraction of the other's time.
std::vector<double> differences(const std::vector<double>& base, const std::vector<double>& other) {
  const double all = std::max(1.0, other.back() - other.front()), ratio = (base.back() - base.front()) / all;
  std::vector<double> d;
  for (std::size_t i = 0; i < base.size(); ++i) d.push_back((base[i] - ratio * other[i]) / all);
  return steps(d);
}

}  // namespace

Estimate both(const Estimate& a, const Estimate& b) {
  constexpr double kLeast = 0.05;
  struct Time {
    double value, above, below;
    explicit Time(const Estimate& gain)
        : value(of(gain.value)), above(of(gain.low) - value), below(value - of(gain.high)) {}
    static double of(double gain) { return 1 / std::max(2 * kLeast, 1 + gain); }
    double precision() const { return 1 / std::max(1e-9, (above + below) * (above + below)); }
  };
  const Time one(a), other(b);
  const double share = one.precision() / (one.precision() + other.precision()),
               time = share * one.value + (1 - share) * other.value;
  const auto error = [&](double x, double y) { return std::hypot(share * x, (1 - share) * y); };
  return {1 / time - 1, 1 / (time + error(one.above, other.above)) - 1,
          1 / std::max(kLeast, time - error(one.below, other.below)) - 1};
}

Foretelling::Foretelling(PilotRun base, std::uint64_t frame_rays, std::uint64_t fill, const CycleResult* frame)
    : base_(base),
      frame_rays_(frame_rays),
      fill_(std::min(fill, base.rays / 4)),
      frame_size_(static_cast<double>(frame_rays)),
      base_places_(places(base_)) {
  if (frame != nullptr && !whole()) count_tests(*frame);
}

/// Counts tests from now on if the time of a test varies less than that of a ray.
void Foretelling::count_tests(const CycleResult& frame) {
  double times = 0;
  const std::vector<std::size_t> classes = testers(*base_.result);
  for (const std::size_t i : classes)
    times += static_cast<double>(frame.uses[i].busy) / static_cast<double>(base_.result->uses[i].busy) /
             static_cast<double>(classes.size());
  const double of_pilot = static_cast<double>(base_.rays);
  if (times <= 1) return;
  const double rays_vary = unsteadiness();
  by_tests_ = true;
  base_places_ = places(base_);
  if (unsteadiness() < rays_vary) {
    frame_size_ = times * of_pilot;
    by_rays_ = std::make_shared<Foretelling>(base_, frame_rays_, fill_);
    return;
  }
  by_tests_ = false;
  base_places_ = places(base_);
}

/// The relative error of the time between fill and drain, from the differences between neighbouring blocks.
double Foretelling::unsteadiness() const {
  const Window w = window(base_, base_places_);
  const std::vector<double> times = means(*base_.result, base_places_, w.begin, w.end, cycle_of);
  return standard_error(steps(times)) / std::max(1.0, times.back() - times.front());
}

Foretelling::Places Foretelling::places(const PilotRun& run) const {
  const std::vector<std::size_t> classes = by_tests_ ? testers(*run.result) : std::vector<std::size_t>{};
  const double each = static_cast<double>(run.rays) / static_cast<double>(std::max<std::size_t>(1, classes.size()));
  Places out;
  for (const ProgressSample& sample : run.result->progress) {
    double done = classes.empty() ? static_cast<double>(sample.completed) : 0;
    for (const std::size_t i : classes)
      done += each * static_cast<double>(sample.busy[i]) / static_cast<double>(run.result->uses[i].busy);
    out.push_back(done);
  }
  return out;
}

double Foretelling::place_of_count(const PilotRun& run, const Places& places, std::uint64_t completed) const {
  if (!by_tests_) return static_cast<double>(completed);
  const CycleResult& result = *run.result;
  return at_count(result, completed, [&](const ProgressSample& s) {
    return places[static_cast<std::size_t>(&s - result.progress.data())];
  });
}

Foretelling::Window Foretelling::window(const PilotRun& other, const Places& places) const {
  const double begin = std::max(place_of_count(base_, base_places_, fill_), place_of_count(other, places, fill_)),
               end = std::min(place_of_count(base_, base_places_, drain_begins(base_)),
                              place_of_count(other, places, drain_begins(other)));
  // A pilot that is never between fill and drain can only be taken as a whole.
  const double rays = static_cast<double>(base_.rays);
  if (end < begin + std::floor(rays / 4)) return {0, rays};
  return {begin, end};
}

double Foretelling::frame_cycles(const PilotRun& run, const Places& places, Window window) const {
  const double all = static_cast<double>(run.result->cycles), rays = static_cast<double>(run.rays);
  if (whole()) return all;
  double each = all / rays;
  if (window.size() < rays) {
    const std::vector<double> times = means(*run.result, places, window.begin, window.end, cycle_of);
    each = (times.back() - times.front()) / (window.size() * (kProgressBlocks - 1) / kProgressBlocks);
  }
  return all + (frame_size_ - rays) * each;
}

Estimate Foretelling::cycles() const {
  const double value = frame_cycles(base_, base_places_, window(base_, base_places_));
  if (whole()) return {value, value, value};
  const double error = 2 * unsteadiness() * value;
  return {value, value - error, value + error};
}

std::vector<double> Foretelling::busy() const {
  std::vector<double> out;
  const Window w = window(base_, base_places_);
  const CycleResult& result = *base_.result;
  const auto place = [this](std::size_t i) { return base_places_[i]; };
  for (std::size_t i = 0; i < result.uses.size(); ++i) {
    const auto value = [i](const ProgressSample& s) { return static_cast<double>(s.busy[i]); };
    double all = static_cast<double>(result.uses[i].busy);
    if (!whole())
      all += (frame_size_ - static_cast<double>(base_.rays)) *
             (at_place(result, place, w.end, value) - at_place(result, place, w.begin, value)) / w.size();
    out.push_back(all);
  }
  return out;
}

Estimate Foretelling::gain(PilotRun relaxed, double deviation, bool warms) const {
  const Places there = places(relaxed);
  const auto gain_by = [&](Window w) {
    return frame_cycles(base_, base_places_, w) / frame_cycles(relaxed, there, w) - 1;
  };
  const auto differences_in = [&](Window w) {
    return differences(means(*base_.result, base_places_, w.begin, w.end, cycle_of),
                       means(*relaxed.result, there, w.begin, w.end, cycle_of));
  };
  Window w = window(relaxed, there);
  std::vector<double> d = differences_in(w);
  double still = 0;  // that it may yet gain
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
  if (const double grown = std::accumulate(middle, d.end(), 0.0) - std::accumulate(d.begin(), middle, 0.0);
      warms && !whole() && grown > 2 * standard_error(d)) {
    const Window earlier{w.begin, w.begin + w.size() / 2};
    w.begin = earlier.end;
    still = std::max(0.0, gain_by(w) - gain_by(earlier));
    d = differences_in(w);
  }
  const double gain = gain_by(w), of_frame = w.size() / frame_size_,
               off = whole() ? 0 : kInOneClass * std::abs(deviation) * (1 + gain) * (1 + gain) / 2,
               half = std::hypot(kErrorsEachSide * standard_error(d) * std::sqrt(1 + of_frame), off);
  const Estimate own{gain, gain - half, gain + half + still};
  if (by_rays_ == nullptr) return own;
  const Estimate by_rays = by_rays_->gain(relaxed, deviation, warms);
  return by_rays.high - by_rays.low < own.high - own.low ? by_rays : own;
}

}  // namespace carousel::ringbus
