#include "app/command_line/command_line.h"

#include <algorithm>
#include <csignal>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/command_line/command_options.h"
#include "app/command_line/common_options.h"
#include "app/commands/accuracy_command.h"
#include "app/commands/certify_command.h"
#include "app/commands/check_command.h"
#include "app/commands/compare_command.h"
#include "app/commands/completion_command.h"
#include "app/commands/follow_command.h"
#include "app/commands/inspect_command.h"
#include "app/commands/report_command.h"
#include "app/commands/run_command.h"
#include "app/commands/schema_command.h"
#include "app/commands/stress_command.h"
#include "app/commands/sweep_command.h"
#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/log.h"
#include "app/host/output.h"
#include "app/host/version_text.h"
#include "app/site/serve_command.h"
#include "app/usage/examples.h"
#include "app/versus/versus_command.h"
#include "core/system/error.h"
#include "core/system/process_memory.h"
#include "core/system/stop_request.h"
#include "core/text/edit_distance.h"

namespace carousel::app {

namespace {

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return near ? fmt::format("; did you mean {}?", *near) : "";
}

/// The nearest command or option, which CLI11 does not suggest.
std::string usage_hint(const CLI::App& program, int argc, const char* const* argv) {
  const std::vector<std::string> commands = command_names(program);
  if (argc < 2) return fmt::format("expected a command: {}", fmt::join(commands, ", "));
  const std::string first = argv[1];
  const bool known = std::find(commands.begin(), commands.end(), first) != commands.end();
  if (!first.empty() && first[0] != '-' && !known)
    return fmt::format("unknown command {}{}; known are {}", first, did_you_mean(first, commands),
                       fmt::join(commands, ", "));
  const CLI::App* command = known ? program.get_subcommand(first) : &program;
  std::vector<std::string> options;
  for (const CLI::Option* option : command->get_options())
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  for (int i = 1; i < argc; ++i) {
    const std::string argument = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (argument.substr(0, 2) == "--" && std::find(options.begin(), options.end(), argument) == options.end())
      return fmt::format("unknown option {}{}", argument, did_you_mean(argument, options));
  }
  return "";
}

struct Arguments {
  bool verbose = false;
  LogArguments log;
  AccuracyArguments accuracy;
  RunArguments run;
  SweepArguments sweep;
  StressArguments stress;
  CheckArguments check;
  InspectArguments inspect;
  CompareArguments compare;
  ReportArguments report;
  ServeArguments serve;
  FollowArguments follow;
  VersusArguments versus;
  SchemaArguments schema;
  CompletionArguments completion;
};

void add_commands(CLI::App& program, Arguments& arguments) {
  program.require_subcommand(1);
  program.set_help_flag("-h,--help", "Print this help and exit");
  const CLI::Option* verbose =
      program.add_flag("--verbose", arguments.verbose, "With --version: also the modules, each with what it brings");
  program.set_version_flag(
      "--version", [verbose] { return verbose->count() > 0 ? version_text() + "\n" + modules_text() : version_text(); },
      "Print version, commit and compiler, and exit");
  add_run(program, arguments.run);
  CLI::App* sweep = program.add_subcommand("sweep", "Simulate one configuration with many values of some keys");
  add_config_options(*sweep, arguments.sweep);
  add_sweep_options(*sweep, arguments.sweep);
  CLI::App* check = program.add_subcommand(
      "check", "Validate a configuration; print it with all defaults, its memory and whether it can deadlock");
  add_config_options(*check, arguments.check);
  add_strict_option(*check, arguments.check);
  check->add_flag("--graph", arguments.check.graph,
                  "Print the network as a graph, topology with nodes and links as YAML, and nothing else (default: all "
                  "keys)");
  check->add_flag("--json", arguments.check.json,
                  "Print the same as JSON, and errors with their places too (default: YAML with comments)");
  CLI::App* stress =
      program.add_subcommand("stress", "Test queue designs under load: loss, order, throughput and latency");
  add_config_options(*stress, arguments.stress, "the queues are tested by themselves");
  add_stress_options(*stress, arguments.stress);
  add_accuracy(program, arguments.accuracy);
  add_inspect(program, arguments.inspect);
  add_compare(program, arguments.compare);
  add_versus(program, arguments.versus);
  add_follow(program, arguments.follow);
  add_report(program, arguments.report);
  add_serve(program, arguments.serve);
  CLI::App* schema = program.add_subcommand("schema", "Print the JSON Schema of configurations or reports");
  schema->add_option("file", arguments.schema.file, "config or report")
      ->required()
      ->check(CLI::IsMember({"config", "report"}));
  CLI::Option* markdown = schema->add_flag("--markdown", arguments.schema.markdown,
                                           "Print every key with its meaning as Markdown (default: JSON Schema)");
  schema
      ->add_option("--graph", arguments.schema.graph,
                   "With config: keys that name nodes and clocks take those of this configuration, whose topology is a "
                   "graph (default: any names)")
      ->excludes(markdown)
      ->type_name("FILE");
  add_plugin_option(*schema, arguments.schema.plugins, "none");
  CLI::App* completion = program.add_subcommand("completion", "Print the completion of this program for a shell");
  completion->add_option("shell", arguments.completion.shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  program.add_subcommand("man", "Print the manual page, for man -l");
  for (CLI::App* command : program.get_subcommands({})) {
    add_log_options(*command, arguments.log);
    command->footer(examples_text(command->get_name()));
  }
  program.footer(first_steps());
}

int run_command_line(int argc, const char* const* argv) {
  CLI::App program{"Carousel simulates ray-tracing hardware in which rays stay put and shapes travel.", "carousel"};
  Arguments arguments;
  add_commands(program, arguments);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    std::ostringstream text;
    program.exit(success, text, text);
    print_result(text.str());
    return kDone;
  } catch (const CLI::ParseError& error) {
    const std::string hint = usage_hint(program, argc, argv);
    spdlog::error("{}\ncarousel --help prints the usage", hint.empty() ? error.what() : hint);
    return kUsage;
  }
  start_log(arguments.log, arguments.run.quiet || arguments.sweep.quiet || arguments.accuracy.quiet ||
                               arguments.stress.quiet || arguments.follow.quiet || arguments.versus.quiet);
  if (program.got_subcommand("run")) return run_command(arguments.run);
  if (program.got_subcommand("sweep")) return sweep_command(arguments.sweep);
  if (program.got_subcommand("stress")) return stress_command(arguments.stress);
  if (program.got_subcommand("check")) return check_command(arguments.check);
  if (program.got_subcommand("accuracy")) {
    const AccuracyArguments& accuracy = arguments.accuracy;
    if (accuracy.certify) return certify_command(accuracy);
    return accuracy.reproduce.empty() ? accuracy_command(accuracy) : reproduce_command(accuracy);
  }
  if (program.got_subcommand("inspect")) return inspect_command(arguments.inspect);
  if (program.got_subcommand("compare")) return compare_command(arguments.compare);
  if (program.got_subcommand("versus")) return versus_command(arguments.versus);
  if (program.got_subcommand("report")) return report_command(arguments.report);
  if (program.got_subcommand("serve")) return serve_command(arguments.serve);
  if (program.got_subcommand("follow")) return follow_command(arguments.follow);
  if (program.got_subcommand("completion")) return completion_command(program, arguments.completion);
  if (program.got_subcommand("man")) return man_command(program);
  return schema_command(arguments.schema);
}

/// Where the process has a limit of its own, a lack of memory or of threads is most likely due to it: says so. Returns
/// whether there is one.
bool blames_the_limit() {
  const std::uint64_t limit = data_memory_limit();
  if (limit > 0)
    spdlog::error("not enough memory: the run needs more than the limit of {} MiB (engine.memory_limit_mib, ulimit -d)",
                  limit >> 20);
  return limit > 0;
}

ExitStatus no_memory() {
  if (!blames_the_limit()) spdlog::error("not enough memory; carousel check prints how much the configuration needs");
  return kUsage;
}

ExitStatus no_thread() {
  if (blames_the_limit()) return kUsage;
  spdlog::error("cannot start a thread: not enough memory, address space or processes (ulimit -v, ulimit -u)");
  return kUsage;
}

int guarded(int argc, const char* const* argv) {
  try {
    return run_command_line(argc, argv);
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) spdlog::error("{}", issue.text());
    return kUsage;
  } catch (const SceneError& error) {
    spdlog::error("{}", error.what());
    return kUsage;
  } catch (const FileError& error) {
    spdlog::error("{}", error.what());
    return kUsage;
  } catch (const Interrupted& error) {
    spdlog::warn("interrupted: {}", error.what());
    return interrupted_status();
  } catch (const std::bad_alloc&) {
    return no_memory();
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again) return no_thread();
    spdlog::error("internal error: {}", error.what());
    return kBroken;
  } catch (const SimulationError& error) {
    spdlog::error("{}", error.what());
    return kBroken;
  } catch (const std::exception& error) {
    // oneTBB throws a std::runtime_error of this text.
    if (std::string_view(error.what()).find("pthread_create") != std::string_view::npos) return no_thread();
    spdlog::error("internal error: {}", error.what());
    return kBroken;
  }
}

}  // namespace

int main(int argc, const char* const* argv) {
  start_log({}, false);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of its writer
  return end_log(guarded(argc, argv));
}

}  // namespace carousel::app
