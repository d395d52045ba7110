#include "report/run/judge_gains.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/numeric/worth_naming.h"
#include "report/run/part_groups.h"
#include "report/text/number_text.h"
#include "report/text/ratio.h"

namespace carousel::report {

namespace {

std::string cold_text(const Bottleneck& b) {
  if (!b.cold_caches) return "";
  const std::string& warm = b.cold_caches->when_warm;
  return fmt::format(
      "; {:.0f} % of the lines that memory reads are read for the first time, and {} gains less in a larger picture{}",
      100 * ratio(b.cold_caches->first, b.cold_caches->reads), b.limits,
      warm == b.limits ? "" : fmt::format(", where {} may gain most", warm.empty() ? "another class" : warm));
}

std::string verdict(const Bottleneck& b, const BottleneckGain* named) {
  if (!b.complete) return "not found out: the search was interrupted";
  if (const auto& small = b.frame_too_small; small && small->search)
    return fmt::format(
        "not found out: {} paths for {} ray slots are too few for a search that takes no longer than the run; from "
        "some {} paths on, or with fewer slots, it can be said; {} was the busiest part, {:.0f} % of the time",
        grouped(small->paths), grouped(small->slots), grouped(small->least_paths), small->busiest, 100 * small->busy);
  if (const auto& small = b.frame_too_small)
    return fmt::format(
        "not found out: {} paths for {} ray slots mostly fill and drain the machine ({:.0f} % of the rays lie "
        "between); from some {} paths on, or with fewer slots, it can be said",
        grouped(small->paths), grouped(small->slots), 100 * small->between, grouped(small->least_paths));
  if (!b.unlike.empty()) return "not found out: the pilot is not like the run: " + b.unlike;
  if (b.gains.empty()) return "not found out: nothing can be relaxed";
  if (named == nullptr) {
    const BottleneckGain& best = b.gains.front();
    const std::string others = best.together > 1 ? fmt::format(" with {} others", best.together - 1) : "";
    const bool noise = best.low <= 0 && best.gain > 0;
    return fmt::format("no class of parts {}: the best relaxation, {}{}, gains {}{}",
                       noise && best.gain > kWorthIt ? "can be told to limit it" : "limits it alone", best.action,
                       others, gain_text(best), noise ? ", which may be noise" : "");
  }
  std::string text = fmt::format("{}{}: {} gains {}", named->low > 0 ? "" : "probably ", named->name, named->action,
                                 gain_text(*named));
  if (!b.rivals.empty()) {
    constexpr std::size_t kShown = 3;
    std::size_t shown = 0;
    if (!b.group.empty())
      text = fmt::format("{} ({} or {}): not to be told apart; {}", b.group, named->name, fmt::join(b.rivals, " or "),
                         text);
    text += b.group.empty() ? "; not to be told apart from it:" : "; then";
    for (const BottleneckGain& gain : b.gains)
      if (shown < kShown && std::find(b.rivals.begin(), b.rivals.end(), gain.name) != b.rivals.end())
        text += fmt::format("{} {} with {}", shown++ == 0 ? "" : ",", gain.name, gain_text(gain));
    if (b.rivals.size() > shown) text += fmt::format(" and {} more", b.rivals.size() - shown);
    return text + cold_text(b);
  }
  const auto next = std::find_if(b.gains.begin(), b.gains.end(),
                                 [&](const auto& gain) { return &gain != named && gain.together == 1; });
  if (next != b.gains.end()) text += fmt::format(", next is {} with {}", next->name, gain_text(*next));
  return text + cold_text(b);
}

std::string untried_text(const Bottleneck& b) {
  std::string out;
  for (const UntriedClass& one : b.untried)
    out += fmt::format("{}{} ({})", out.empty() ? "; not tried: " : ", ", one.name, one.why);
  return out;
}

}  // namespace

std::string gain_text(const BottleneckGain& gain) {
  if (gain.low == gain.high) return fmt::format("{:+.1f} %", 100 * gain.gain);
  return fmt::format("{:+.1f} % ({:+.1f} to {:+.1f} %)", 100 * gain.gain, 100 * gain.low, 100 * gain.high);
}

Bottleneck judge_gains(Bottleneck found, const std::function<bool(const std::string&)>& fades) {
  const BottleneckGain *named = nullptr, *lasting = nullptr;
  const auto likely = [](const BottleneckGain& gain) { return likely_gain(gain.gain, gain.low); };
  for (const BottleneckGain& gain : found.gains) {
    if (gain.together != 1 || !worth_naming(gain.gain, gain.low)) continue;
    if (named == nullptr || likely(gain) > likely(*named)) named = &gain;
    if ((!fades || !fades(gain.name)) && (lasting == nullptr || likely(gain) > likely(*lasting))) lasting = &gain;
  }
  if (lasting != nullptr && likely(*lasting) >= likely(*named) - kTie) named = lasting;
  found.limits = named == nullptr ? "" : named->name;
  found.rivals.clear();
  for (const BottleneckGain& gain : found.gains)
    if (named != nullptr && &gain != named && gain.high > named->low && gain.high > kWorthIt)
      found.rivals.push_back(gain.name);
  found.group = found.rivals.empty() ? "" : group_of(found.limits);
  for (const std::string& rival : found.rivals)
    if (group_of(rival) != found.group) found.group = "";
  found.verdict = verdict(found, named) + untried_text(found);
  return found;
}

}  // namespace carousel::report
