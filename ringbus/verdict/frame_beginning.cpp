#include "ringbus/verdict/frame_beginning.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "ringbus/verdict/progress_blocks.h"

namespace carousel::ringbus {

namespace {

using cycle::CycleResult;
using cycle::ProgressSample;

/// Two blocks are about as busy if the parts of the time for which they were differ by this, in units of the root of
/// the frame's: 3 % of the time for a class that is busy for 1 %, and 30 % for one that always is.
constexpr double kAsBusy = 0.3;
/// The weight of the mean of the beginning, beside that of a block that is just as busy.
constexpr double kOfMean = 0.5;

double at_cycle(const CycleResult& run, double cycle, const auto& value) {
  return at_place(
      run, [&](std::size_t i) { return static_cast<double>(run.progress[i].at); }, cycle, value);
}

double completed_of(const ProgressSample& sample) {
  return static_cast<double>(sample.completed);
}

/// When a run had completed so many rays.
double when(const CycleResult& run, double completed) {
  return at_place(
      run, [&](std::size_t i) { return completed_of(run.progress[i]); }, completed, cycle_of);
}

/// How busy the run kept the classes of parts in blocks of this length, from its start.
class BusyBlocks {
 public:
  BusyBlocks(const CycleResult& run, double length, std::size_t blocks) {
    for (std::size_t i = 0; i < run.uses.size(); ++i)
      if (run.uses[i].parts > 0 && run.uses[i].busy > 0) classes_.push_back(i);
    for (std::size_t block = 0; block < blocks; ++block)
      for (const std::size_t i : classes_) {
        const auto reached = [&](std::size_t at) {
          return at_cycle(run, static_cast<double>(at) * length,
                          [i](const ProgressSample& s) { return static_cast<double>(s.busy[i]); });
        };
        const cycle::ClassUse& use = run.uses[i];
        const double unit = std::sqrt(static_cast<double>(use.busy) * use.parts / static_cast<double>(run.cycles));
        shares_.push_back((reached(block + 1) - reached(block)) / (length * unit));
      }
  }
  /// 1 if both blocks are as busy, and less the more they differ.
  double likeness(std::size_t a, std::size_t b) const {
    double squares = 0;
    for (std::size_t i = 0; i < classes_.size(); ++i) {
      const double d = shares_[a * classes_.size() + i] - shares_[b * classes_.size() + i];
      squares += d * d;
    }
    return std::exp(-squares / (2 * kAsBusy * kAsBusy));
  }

 private:
  std::vector<std::size_t> classes_;
  std::vector<double> shares_;  // block by block
};

/// Blocks of a frame's beginning, and those of its rest, which are as long.
class Blocks {
 public:
  Blocks(const CycleResult& run, const FrameBeginning& beginning, std::uint64_t fill)
      : length_(beginning.part * static_cast<double>(run.cycles) / kProgressBlocks),
        rest_(static_cast<std::size_t>(std::lround((1 / beginning.part - 1) * kProgressBlocks))),
        busy_(run, length_, kProgressBlocks + rest_) {
    for (std::size_t block = 1; block <= kProgressBlocks; ++block) {
      completed_.push_back(at_cycle(run, static_cast<double>(block) * length_, completed_of));
      if (completed_.back() < static_cast<double>(fill)) filling_ = std::clamp(block, filling_, kProgressBlocks / 2);
    }
  }
  double length() const { return length_; }
  /// That say nothing of the rest.
  std::size_t filling() const { return filling_; }
  /// Rays that the run had completed at the end of a block.
  double completed(std::size_t block) const { return completed_[block]; }
  /// The mean of what blocks of the rest are expected to have, by what those of the beginning have and by what is
  /// expected of one that is like none.
  double of_rest(const std::vector<double>& values, double of_unknown) const {
    double out = 0;
    for (std::size_t block = kProgressBlocks; block < kProgressBlocks + rest_; ++block) {
      double sum = kOfMean * of_unknown, weights = kOfMean;
      for (std::size_t like = filling_; like < kProgressBlocks; ++like) {
        const double weight = busy_.likeness(block, like);
        sum += weight * values[like];
        weights += weight;
      }
      out += sum / weights / static_cast<double>(rest_);
    }
    return out;
  }

 private:
  double length_;
  std::size_t rest_;
  BusyBlocks busy_;
  std::vector<double> completed_;
  std::size_t filling_ = kProgressBlocks / 8;
};

}  // namespace

FrameBeginning beginning_of(const CycleResult& run, double part) {
  return {part, static_cast<std::uint64_t>(at_cycle(run, part * static_cast<double>(run.cycles), completed_of))};
}

double part_of(const CycleResult& run, double rays) {
  return std::min(1.0, when(run, rays) / static_cast<double>(run.cycles));
}

double unknown_rest(const CycleResult& run, const FrameBeginning& beginning, std::uint64_t fill) {
  return Blocks(run, beginning, fill).of_rest(std::vector<double>(kProgressBlocks, 0.0), 1);
}

bool tells_of_rest(const CycleResult& run, double part, std::uint64_t fill) {
  constexpr double kMostUnknown = 0.25;
  return part >= 1 || (1 - part) * unknown_rest(run, beginning_of(run, part), fill) <= kMostUnknown;
}

double part_that_takes(const CycleResult& run, std::uint64_t rays, double taken) {
  return taken <= 0 ? 0 : std::min({1.0, taken, part_of(run, taken * static_cast<double>(rays))});
}

Estimate gain_by_beginning(const CycleResult& run, const CycleResult& relaxed, const FrameBeginning& beginning,
                           std::uint64_t fill, bool warms) {
  // Chosen so that 95 % and more of the gains of machines drawn by `script/verdicts --drawn` lie in their intervals.
  constexpr double kSteps = 0.35, kTrend = 1.5, kUnknown = 0.5, kLittle = 0.01, kSeeds = 3.1, kLeast = 0.05,
                   kUsual = 0.3, kPower = 0.3, kDrift = 0.05;
  const Blocks blocks(run, beginning, fill);
  std::vector<double> taken;  // of the relaxed machine's cycles for each of the run's
  double reached = 0;
  for (std::size_t block = 0; block < kProgressBlocks; ++block) {
    const double now = when(relaxed, blocks.completed(block));
    taken.push_back((now - reached) / blocks.length());
    reached = now;
  }
  const auto full = taken.begin() + static_cast<std::ptrdiff_t>(blocks.filling());
  const double count = static_cast<double>(taken.end() - full), mean = std::accumulate(full, taken.end(), 0.0) / count;
  double deviation = 0, steps = 0;
  for (auto at = full; at != taken.end(); ++at) {
    deviation += (*at - mean) * (*at - mean) / count;
    if (at != full) steps += (*at - at[-1]) * (*at - at[-1]) / (2 * (count - 1));
  }
  const auto middle = full + (taken.end() - full) / 2;
  const auto mean_of = [](auto begin, auto end) {
    return std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin);
  };
  const double left = 1 - beginning.part, unknown = unknown_rest(run, beginning, fill),
               still = warms ? left * std::max(0.0, mean_of(full, middle) - mean_of(middle, taken.end())) : 0,
               time = std::max(kLeast, beginning.part * reached / (kProgressBlocks * blocks.length()) +
                                           left * blocks.of_rest(taken, (1 + mean) / 2)),
               seeds = kSeeds * std::sqrt(steps * beginning.part / kProgressBlocks),
               trend = kTrend * std::sqrt(std::max(0.0, deviation - steps)),
               error = std::pow(kUsual / beginning.part, kPower) *
                           std::hypot(std::hypot(left * kSteps * std::sqrt(steps), left * trend),
                                      left * std::hypot(kUnknown * unknown, kDrift), seeds) +
                       kLittle * left;
  return {1 / time - 1, 1 / (time + error) - 1, 1 / std::max(kLeast, time - error - still) - 1};
}

}  // namespace carousel::ringbus
