#pragma once

#include <string>

#include "report/sections/bottleneck.h"

namespace carousel::report {

/// A gain below this is not worth a verdict.
inline constexpr double kWorthIt = 0.05;

/// Names the class of parts that limits the machine from the gains, which stand greatest first: fills in `limits`,
/// `rivals` and `verdict`. A gain whose interval has its lower end at 0 or below is inside the noise and names nothing.
Bottleneck judge_gains(Bottleneck found);

/// "+12.3 % (+10.1 to +14.5 %)", or without an interval if it is exact.
std::string gain_text(const BottleneckGain& gain);

}  // namespace carousel::report
