#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/host/log.h"
#include "app/run/prepare.h"

namespace carousel::app {

// Options that several commands have.

constexpr const char* kJsonHelp = "Print the result as JSON instead of a table (default: table)";
constexpr const char* kQuietHelp = "Print errors only, and the result if --json is given (default: progress and table)";

/// --set.
void add_set_option(CLI::App& command, std::vector<std::string>& sets);
/// --log-level and --log-file.
void add_log_options(CLI::App& command, LogArguments& arguments);
/// The file of the configuration, and --set. `without`: what the command does without one; null: it needs one.
void add_config_options(CLI::App& command, ConfigArguments& arguments, const char* without = nullptr);
/// `--plugin` for commands that take no configuration.
void add_plugin_option(CLI::App& command, std::vector<std::string>& plugins, const char* absent);
/// --charge-all.
void add_charge_all_option(CLI::App& command, ConfigArguments& arguments);
/// --strict.
void add_strict_option(CLI::App& command, ConfigArguments& arguments);

}  // namespace carousel::app
