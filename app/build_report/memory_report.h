#pragma once

#include "app/run/prepare.h"
#include "report/run/report.h"
#include "ringbus/cycle/memory/memory_trace.h"

namespace carousel::app {

report::Dram dram_section(const ringbus::DramUse& use);

/// The report of the memory alone.
report::Report memory_report(const Prepared& prepared, const ringbus::MemoryTraceResult& result);

}  // namespace carousel::app
