#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ringbus/results/cycle_result.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "ringbus/verdict/frame_beginning.h"
#include "ringbus/verdict/search_choices.h"

namespace carousel::ringbus {

// Classes that may be the one to name race over the frame: it is simulated for two at a time, further and further,
// until no other may well gain more than the one to be named. Classes are given by index.

/// True if a class may well gain more than this, by more than settles a tie. The upper end of 95 % of the gains is more
/// than may well be: of 300 machines that the search was tuned on as many were right with 0.7 of the way to it, for a
/// tenth less of simulations. Intervals were a tenth narrower then. One class of a group may gain what the group does,
/// but no more.
inline bool may_well_gain(const Gain& one, double than) {
  constexpr double kWell = 0.64;
  const double more = one.together == 1 ? kWell * (one.high - one.gain) : 0;
  return one.together > 0 && one.gain + more > than + kEnough;
}

/// The classes that might be the one to name, the greatest gain first: those that were relaxed alone, and those of
/// groups that gain more than the class to be named.
inline std::vector<std::size_t> worth_a_second_look(const std::vector<Gain>& gains, std::size_t most) {
  const double enough = std::max(kEnough, surely(gains));
  const std::optional<std::size_t> named = named_gain(gains);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < gains.size(); ++i)
    if (gains[i].high >= enough &&
        (gains[i].together == 1 || may_well_gain(gains[i], named ? gains[*named].gain : kEnough)))
      out.push_back(i);
  greatest_first(gains, out);
  out.resize(std::min(out.size(), most));
  return out;
}

/// True if a gain is known by a part of the frame.
inline bool any_frame(const std::vector<Gain>& gains) {
  return std::any_of(gains.begin(), gains.end(), [](const Gain& one) { return one.frame > 0; });
}

/// The class for which the frame is simulated next, or further: of the one to be named and its first rival that of
/// which less of the frame is known, and else the one with the wider interval. Absent if nothing is left to find out.
/// Two at a time are told apart as LUCB does (S. Kalyanakrishnan et al., PAC subset selection in stochastic multi-armed
/// bandits, ICML 2012); its rival, the one whose interval reaches highest, is often one of which a pilot says little.
inline std::optional<std::size_t> next_contender(const std::vector<Gain>& gains) {
  const std::optional<std::size_t> named = named_gain(gains);
  std::optional<std::size_t> rival;
  for (const std::size_t i : worth_a_second_look(gains, gains.size()))
    if (!rival && i != named && gains[i].frame < 1) rival = i;
  if (!named || gains[*named].frame >= 1) return rival;
  if (!rival) return std::nullopt;
  const Gain &first = gains[*named], &second = gains[*rival];
  if (first.frame != second.frame) return first.frame < second.frame ? named : rival;
  return first.high - first.low > second.high - second.low ? named : rival;
}

/// True if another class may well gain more than the one to be named.
inline bool may_be_beaten(const std::vector<Gain>& gains, std::size_t named) {
  return std::any_of(gains.begin(), gains.end(),
                     [&](const Gain& one) { return &one != &gains[named] && may_well_gain(one, gains[named].gain); });
}

/// True if a gain is told so roughly that it is worth to know more of it although nothing may beat it: within 65
/// points.
inline bool told_roughly(const Gain& one) {
  constexpr double kRough = 0.65;
  return one.high - one.low > kRough && one.frame < 1;
}

/// The class for which the frame is simulated next: that to be named, if only a pilot tells of it that is not `alike`
/// the run or tells too little of it, which `unsure` says, or if nothing may well beat it and it is told roughly or may
/// gain nothing; and else one of two contenders. Absent if nothing is left to find out.
template <class Unsure>
std::optional<std::size_t> next_look(const std::vector<Gain>& gains, bool alike, const Unsure& unsure) {
  const std::optional<std::size_t> named = named_gain(gains);
  if (!named) return next_contender(gains);
  const Gain& one = gains[*named];
  const bool won = alike && !may_be_beaten(gains, *named), gains_some = one.low > 0,
             by_little = one.frame <= 0 && (!alike || unsure(*named));
  if (won && !by_little && !told_roughly(one) && (gains_some || one.frame > 0)) return std::nullopt;
  return won || (by_little && gains_some) ? named : next_contender(gains);
}

/// The part of the frame that is simulated next for a class of which `known` is known: at first a sixth of it, or three
/// times what fills the machine (`fill`, rays), or as much as tells of the rest; then twice as much; but no more than
/// `most`. 0 if that tells hardly more than is known.
inline double next_part(const cycle::CycleResult& run, double known, std::uint64_t fill, double most) {
  constexpr double kMore = 2, kWorth = 1.5, kFills = 3, kFirst = 0.16;
  const double least =
      std::min(1.0, known > 0 ? kWorth * known : std::max(kFirst, part_of(run, kFills * static_cast<double>(fill))));
  double part = known > 0 ? std::min(1.0, kMore * known) : least;
  while (!tells_of_rest(run, part, fill)) part = std::min(1.0, kMore * part);
  part = std::min(part, most);
  return part >= least && tells_of_rest(run, part, fill) ? part : 0;
}

}  // namespace carousel::ringbus
