#include "app/command_line/common_options.h"

#include <fmt/format.h>

namespace carousel::app {

void add_set_option(CLI::App& command, std::vector<std::string>& sets) {
  command
      .add_option(
          "--set", sets,
          "Set one key of the configuration, e.g. image.width=256; may be repeated (default: the file's values)")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
}

void add_log_options(CLI::App& command, LogArguments& arguments) {
  command
      .add_option("--log-level", arguments.level,
                  "Messages to print: debug, info, warning or error (default: warning; info in a --log-file)")
      ->check(CLI::IsMember(log_levels()))
      ->type_name("LEVEL");
  command
      .add_option("--log-file", arguments.file,
                  "Write messages with their times to a file; the terminal gets warnings and errors (default: none)")
      ->type_name("FILE");
}

void add_config_options(CLI::App& command, ConfigArguments& arguments, const char* without) {
  const std::string absent = without == nullptr ? "" : fmt::format(" (default: {})", without);
  command.add_option("config", arguments.config, "Configuration file, YAML or JSON" + absent)
      ->required(without == nullptr)
      ->type_name("FILE");
  add_set_option(command, arguments.sets);
}

void add_plugin_option(CLI::App& command, std::vector<std::string>& plugins, const char* absent) {
  command
      .add_option("--plugin", plugins,
                  fmt::format("Shared library whose names are known too; may be repeated (default: {})", absent))
      ->allow_extra_args(false)
      ->type_name("FILE");
}

void add_charge_all_option(CLI::App& command, ConfigArguments& arguments) {
  command.add_flag("--charge-all", arguments.charge_all,
                   "Charge everything that has a key, as far as the machine may have it (default: as configured)");
}

void add_strict_option(CLI::App& command, ConfigArguments& arguments) {
  command.add_flag(
      "--strict", arguments.strict,
      "Refuse a configuration that sets keys which the machine ignores; check: also one whose scene is imported "
      "with warnings (default: they are named)");
}

}  // namespace carousel::app
