#include "ringbus/results/trace.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

namespace {

std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = (a ^ a >> 29) * 0x9e3779b97f4a7c15ull + b;
  x = (x ^ x >> 32) * 0xbf58476d1ce4e5b9ull;
  return x ^ x >> 31;
}

}  // namespace

std::string step_text(const Step& step) {
  constexpr std::array<std::string_view, 9> kNames{"new rays",
                                                   "issues packet",
                                                   "takes packet",
                                                   "has tested packet",
                                                   "has tested the ray in slot",
                                                   "retires packet",
                                                   "hands over completed rays",
                                                   "shades",
                                                   "places"};
  const auto kind = static_cast<std::size_t>(step.kind);
  std::string text = fmt::format("cycle {}, node {}: {}", step.at, step.node, kNames[kind]);
  if (step.kind >= StepKind::kIssue && step.kind <= StepKind::kRetire) text += fmt::format(" {}", step.packet);
  return text + fmt::format(" ({} rays)", step.rays);
}

void EpochDigests::halve() {
  for (std::size_t i = 0; 2 * i < digests.size(); ++i)
    digests[i] = mix(digests[2 * i], 2 * i + 1 < digests.size() ? digests[2 * i + 1] : 0);
  digests.resize((digests.size() + 1) / 2);
  cycles_each *= 2;
}

EpochDigests combine(const std::vector<const Trace*>& traces) {
  EpochDigests out;
  for (const Trace* trace : traces) {
    if (out.digests.size() < trace->epochs().size()) out.digests.resize(trace->epochs().size());
    for (std::size_t e = 0; e < trace->epochs().size(); ++e)
      if (trace->epochs()[e] != 0) out.digests[e] += mix(trace->epochs()[e], trace->node());
  }
  while (out.digests.size() > EpochDigests::kMaxEpochs) out.halve();
  return out;
}

std::vector<Step> merge_steps(const std::vector<const Trace*>& traces) {
  std::vector<Step> all;
  for (const Trace* trace : traces) all.insert(all.end(), trace->steps().begin(), trace->steps().end());
  std::stable_sort(all.begin(), all.end(),
                   [](const Step& a, const Step& b) { return a.at != b.at ? a.at < b.at : a.node < b.node; });
  return all;
}

}  // namespace carousel::ringbus::cycle
