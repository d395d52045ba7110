#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ringbus/verdict/foretell.h"

namespace carousel::ringbus {

/// A class of parts that is busy for another fraction of the time in the frame that a pilot foretells than in the run.
struct UnlikePart {
  std::string_view name;
  double foretold = 0, ran = 0;
};

/// How the frame that a pilot foretells differs from the run.
struct Likeness {
  double cycles = 0;                ///< foretold
  double deviation = 0;             ///< of the run's cycles from these, as a fraction
  double uncertainty = 0;           ///< of the foretold cycles, from the pilot alone, as a fraction
  bool other_cycles = false;        ///< the cycles differ
  std::vector<UnlikePart> parts{};  ///< that differ

  /// The fraction of the time that the foretelling of a gain may be off by.
  double off() const;
  /// Why the pilot is not like the run: other cycles, or the busy time of a part that matters. One such part alone may
  /// differ a little. Empty if they are alike.
  std::string veto(const std::function<bool(std::string_view part)>& does_matter) const;
};

/// Values differ if they do so by more than the pilot's uncertainty and what two schedules differ by for no reason that
/// a pilot could know.
Likeness likeness(const Foretelling& foretold, const cycle::CycleResult& run);

}  // namespace carousel::ringbus
