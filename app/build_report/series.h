#pragma once

#include "report/sections/time_series.h"
#include "ringbus/results/time_series.h"

namespace carousel::app {

report::TimeSeries series_section(const ringbus::TimeSeries& series);

}  // namespace carousel::app
