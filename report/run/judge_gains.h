#pragma once

#include <functional>
#include <string>

#include "report/sections/bottleneck.h"

namespace carousel::report {

/// Names the class of parts that limits the machine from the gains, which stand greatest first: fills in `limits`,
/// `rivals`, `group` and `verdict`. A gain that is not worth_naming names nothing, nor does that of classes that were
/// relaxed together. A class that gains less in a larger frame, which `fades` says, gives way to another one that gains
/// as much within 3 points. `cold_caches` are those of the class that is named.
Bottleneck judge_gains(Bottleneck found, const std::function<bool(const std::string& part)>& fades = {});

/// "+12.3 % (+10.1 to +14.5 %)", or without an interval if it is exact.
std::string gain_text(const BottleneckGain& gain);

}  // namespace carousel::report
