#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/numeric/grow.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A kind of step, by which two runs are compared.
enum class StepKind : std::uint8_t {
  kNewRays,    ///< rays joined the root's collection
  kIssue,      ///< a packet left the issue queue
  kTake,       ///< a packet came in and its IDs were looked through
  kTested,     ///< a packet's tests were done
  kTestedRay,  ///< the tests of a single ray were done, where there are no packets
  kRetire,     ///< a packet retired at its owner
  kComplete,   ///< rays were handed over to shading
  kShade,      ///< rays were shaded
  kPlace,      ///< rays were given slots
};

struct Step {
  Cycle at = 0;
  std::uint32_t node = 0;  ///< resource; beyond them ray control and shading
  StepKind kind = StepKind::kNewRays;
  std::uint32_t packet = 0;  ///< the packet's ID, or the slot of a single ray
  std::uint32_t rays = 0;
  friend bool operator==(const Step&, const Step&) = default;
};
std::string step_text(const Step& step);

/// The cycles whose steps are kept.
struct TraceWindow {
  Cycle first = kNever, end = kNever;
};

/// The steps of one agent: a digest for each epoch, and every step of a window.
class Trace {
 public:
  static constexpr Cycle kEpoch = 4096;

  Trace(std::uint32_t node, TraceWindow window) : node_(node), window_(window) {}

  void note(Cycle at, StepKind kind, std::uint32_t packet, std::size_t rays) {
    const std::size_t epoch = at / kEpoch;
    grow_to(epochs_, epoch + 1);
    std::uint64_t x = epochs_[epoch] ^ (at << 8 | static_cast<std::uint64_t>(kind));
    x = (x ^ x >> 32) * 0xd6e8feb86659fd93ull + (std::uint64_t{packet} << 32 | static_cast<std::uint32_t>(rays));
    epochs_[epoch] = (x ^ x >> 32) * 0xd6e8feb86659fd93ull;
    if (at >= window_.first && at < window_.end) [[unlikely]]
      steps_.push_back({at, node_, kind, packet, static_cast<std::uint32_t>(rays)});
  }

  std::uint32_t node() const { return node_; }
  const std::vector<std::uint64_t>& epochs() const { return epochs_; }
  const std::vector<Step>& steps() const { return steps_; }

 private:
  std::uint32_t node_;
  TraceWindow window_;
  std::vector<std::uint64_t> epochs_;
  std::vector<Step> steps_;
};

/// The digests of a run, one for each stretch of equal length; at most kMaxEpochs of them.
struct EpochDigests {
  static constexpr std::size_t kMaxEpochs = 256;
  Cycle cycles_each = Trace::kEpoch;
  std::vector<std::uint64_t> digests;
  friend bool operator==(const EpochDigests&, const EpochDigests&) = default;

  /// Makes them half as many and twice as long.
  void halve();
};
EpochDigests combine(const std::vector<const Trace*>& traces);

/// The steps of all agents in order of time, then node, then as they were done.
std::vector<Step> merge_steps(const std::vector<const Trace*>& traces);

}  // namespace carousel::ringbus::cycle
