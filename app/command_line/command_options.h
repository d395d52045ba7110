#pragma once

#include <CLI/CLI.hpp>

#include "app/commands/accuracy_command.h"
#include "app/commands/compare_command.h"
#include "app/commands/follow_command.h"
#include "app/commands/inspect_command.h"
#include "app/commands/report_command.h"
#include "app/commands/run_command.h"
#include "app/commands/stress_command.h"
#include "app/commands/sweep_command.h"
#include "app/site/serve_command.h"
#include "app/versus/versus_command.h"

namespace carousel::app {

// The commands that have more than a few options, with their options. The arguments outlive the parser.

void add_run(CLI::App& program, RunArguments& arguments);
void add_accuracy(CLI::App& program, AccuracyArguments& arguments);
void add_inspect(CLI::App& program, InspectArguments& arguments);
void add_compare(CLI::App& program, CompareArguments& arguments);
void add_report(CLI::App& program, ReportArguments& arguments);
void add_serve(CLI::App& program, ServeArguments& arguments);
void add_versus(CLI::App& program, VersusArguments& arguments);
void add_follow(CLI::App& program, FollowArguments& arguments);
void add_stress_options(CLI::App& command, StressArguments& arguments);
void add_sweep_options(CLI::App& command, SweepArguments& arguments);

}  // namespace carousel::app
