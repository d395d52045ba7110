#include "app/commands/command_line.h"

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

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
#include "app/host/log.h"
#include "app/host/output.h"
#include "app/host/version_text.h"
#include "app/usage/examples.h"
#include "core/config/edit_distance.h"
#include "core/system/error.h"

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
  LogArguments log;
  AccuracyArguments accuracy;
  RunArguments run;
  SweepArguments sweep;
  StressArguments stress;
  CheckArguments check;
  InspectArguments inspect;
  CompareArguments compare;
  ReportArguments report;
  FollowArguments follow;
  SchemaArguments schema;
  CompletionArguments completion;
};

constexpr const char* kJsonHelp = "Print the result as JSON instead of a table (default: table)";
constexpr const char* kQuietHelp = "Print errors only, and the result if --json is given (default: progress and table)";

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

void add_config_options(CLI::App& command, ConfigArguments& arguments, const char* without = nullptr) {
  const std::string absent = without == nullptr ? "" : fmt::format(" (default: {})", without);
  command.add_option("config", arguments.config, "Configuration file, YAML or JSON" + absent)
      ->required(without == nullptr)
      ->type_name("FILE");
  add_set_option(command, arguments.sets);
}

void add_run(CLI::App& program, RunArguments& r) {
  CLI::App* run = program.add_subcommand("run", "Simulate one configuration; write a report and the picture");
  add_config_options(*run, r);
  run->add_option("--out", r.out, "Folder for report and picture (default: out/<config name>)")->type_name("DIR");
  run->add_flag("--hits", r.hits, "Write hits.csv, one row per ray (default: not written)");
  run->add_option("--dump-rays", r.dump_rays,
                  "Write all rays as CSV, which workload: {rays_from: FILE} reads (default: not written)")
      ->type_name("FILE");
  run->add_option("--dump-memory", r.dump_memory,
                  "Write the requests to the simulated memory as CSV, which workload: {memory_trace: FILE} reads "
                  "(default: not written)")
      ->type_name("FILE");
  run->add_flag(
      "--audit", r.audit,
      "With sampling.fraction: simulate the whole frame, too, and say how far off the estimates are (default: "
      "not simulated)");
  run->add_flag("--no-html", r.no_html, "Do not write report.html (default: written)");
  CLI::Option* trace = run->add_option("--trace", r.trace.file,
                                       "Write a timeline of events that ui.perfetto.dev opens (default: not written)")
                           ->type_name("FILE");
  run->add_option(
         "--trace-window", r.trace.window,
         "With --trace: only events that begin between these cycles, or seconds of a native run (default: all)")
      ->needs(trace)
      ->type_name("A:B");
  run->add_option("--trace-sample", r.trace.every, "With --trace: only every N-th packet of each resource")
      ->needs(trace)
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  run->add_option("--trace-events", r.trace.events, "With --trace: most events")
      ->needs(trace)
      ->check(CLI::Range(std::size_t{1'000}, std::size_t{100'000'000}))
      ->capture_default_str();
  run->add_flag("--json", r.json, kJsonHelp);
  run->add_flag("--quiet", r.quiet, kQuietHelp);
  run->add_flag("--force", r.force,
                "Run although the topology can deadlock, and replace the results of another configuration "
                "(default: both refused)");
}

void add_accuracy(CLI::App& program, AccuracyArguments& a) {
  CLI::App* accuracy = program.add_subcommand("accuracy", "Measure the time and the errors of every level of accuracy");
  add_config_options(*accuracy, a, "a built-in scene of instances");
  accuracy->add_option("--out", a.out, "Folder for accuracy.json and accuracy.html (default: out/<config name>)")
      ->type_name("DIR");
  accuracy->add_option("--rays", a.rays, "Most rays of the scene to compare with exact arithmetic")
      ->check(CLI::Range(1u, 10'000'000u))
      ->capture_default_str();
  accuracy->add_option("--hard-rays", a.hard_rays, "Number of rays in each built-in hard case")
      ->check(CLI::Range(1u, 10'000'000u))
      ->capture_default_str();
  accuracy->add_option("--repetitions", a.repetitions, "Number of times each timing is repeated")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  accuracy->add_option("--seed", a.seed, "Seed of the hard cases")->capture_default_str();
  accuracy->add_flag("--json", a.json, kJsonHelp);
  accuracy->add_flag("--quiet", a.quiet, kQuietHelp);
  accuracy->add_flag("--force", a.force,
                     "Replace the results of another configuration in the folder (default: refused)");

  CLI::Option* certify = accuracy->add_flag(
      "--certify", a.certify,
      "Test the promises of the levels with hard random cases instead; a configuration selects one level (default: "
      "all levels)");
  CLI::Option* cases =
      accuracy
          ->add_option("--cases", a.cases, "With --certify: number of cases per property (default: --seconds decides)")
          ->needs(certify);
  accuracy->add_option("--seconds", a.seconds, "With --certify: time limit in seconds")
      ->check(CLI::PositiveNumber)
      ->needs(certify)
      ->excludes(cases)
      ->capture_default_str();
  accuracy
      ->add_option("--reproduce", a.reproduce,
                   "Test one case again, as --certify prints it, or the cases in a file (default: none)")
      ->excludes(certify)
      ->type_name("CASE");
}

void add_inspect(CLI::App& program, InspectArguments& i) {
  CLI::App* inspect = program.add_subcommand("inspect", "List a scene's contents, the effects it needs and their cost");
  inspect->add_option("scene", i.scene, "glTF file, or builtin:<name>")->required()->type_name("SCENE");
  add_set_option(*inspect, i.sets);
  inspect->add_flag("--json", i.json, kJsonHelp);
}

void add_compare(CLI::App& program, CompareArguments& c) {
  CLI::App* compare =
      program.add_subcommand("compare", "Show runs side by side, and what differs in their configurations");
  compare
      ->add_option("runs", c.runs, "Two or more report.json, or their folders; the first is compared with the others")
      ->required()
      ->expected(2, 26)
      ->type_name("PATH");
  compare->add_flag("--all", c.all, "Also list every other value that differs (default: their number)");
  compare
      ->add_option("--only", c.only,
                   "Show only rows, keys and values whose names contain this; * is any text (default: all)")
      ->type_name("PATTERN");
  compare->add_flag("--json", c.json, kJsonHelp);
  compare->add_option("--html", c.html, "Write a page with the comparison as tables and charts (default: none)")
      ->type_name("FILE");
  compare->add_option("--expect", "With `identical`: exit status 1 if the reports differ (default: 0 in any case)")
      ->check(CLI::IsMember({"identical"}))
      ->each([&c](const std::string&) { c.expect_identical = true; });
}

void add_report(CLI::App& program, ReportArguments& r) {
  CLI::App* report =
      program.add_subcommand("report", "Make the HTML page of a run, or of another command's JSON, again");
  report
      ->add_option("folder", r.folder,
                   "Folder of a run or a sweep, or the JSON of run, sweep, stress, accuracy or follow")
      ->required()
      ->type_name("PATH");
  report
      ->add_option("--point", r.point, "Make the page of one point of the sweep in the folder (default: of the sweep)")
      ->type_name("DIGEST");
  report->add_option("--out", r.out, "Page to write (default: beside the JSON, with the ending .html)")
      ->type_name("FILE");
}

void add_follow(CLI::App& program, FollowArguments& f) {
  CLI::App* follow = program.add_subcommand("follow", "Tell the life of one ray: its waits, packets, tests and hit");
  add_config_options(*follow, f);
  follow->add_option("--pixel", f.pixel, "Pixel, from the left and from the top, both from 0 (default: none)")
      ->type_name("X,Y");
  follow->add_option("--sample", f.sample, "Sample of the pixel")->capture_default_str();
  follow->add_option("--bounce", f.bounce, "Bounce of the path: 0 is the camera ray")->capture_default_str();
  follow->add_flag("--shadow", f.shadow, "The shadow ray of that bounce (default: the ray that seeks a surface)");
  follow->add_option("--ray", f.ray, "Number of the ray in hits.csv, in place of a pixel (default: none)")
      ->type_name("ID");
  follow->add_flag("--json", f.json, kJsonHelp);
  follow->add_flag("--quiet", f.quiet, kQuietHelp);
}

void add_commands(CLI::App& program, Arguments& arguments) {
  program.require_subcommand(1);
  program.set_help_flag("-h,--help", "Print this help and exit");
  program.set_version_flag("--version", version_text, "Print version, commit and compiler, and exit");
  add_run(program, arguments.run);
  CLI::App* sweep = program.add_subcommand("sweep", "Simulate one configuration with many values of some keys");
  add_config_options(*sweep, arguments.sweep);
  add_sweep_options(*sweep, arguments.sweep);
  CLI::App* check = program.add_subcommand(
      "check", "Validate a configuration; print it with all defaults, its memory and whether it can deadlock");
  add_config_options(*check, arguments.check);
  CLI::App* stress =
      program.add_subcommand("stress", "Test queue designs under load: loss, order, throughput and latency");
  add_config_options(*stress, arguments.stress, "the queues are tested by themselves");
  add_stress_options(*stress, arguments.stress);
  add_accuracy(program, arguments.accuracy);
  add_inspect(program, arguments.inspect);
  add_compare(program, arguments.compare);
  add_follow(program, arguments.follow);
  add_report(program, arguments.report);
  CLI::App* schema = program.add_subcommand("schema", "Print the JSON Schema of configurations or reports");
  schema->add_option("file", arguments.schema.file, "config or report")
      ->required()
      ->check(CLI::IsMember({"config", "report"}));
  schema->add_flag("--markdown", arguments.schema.markdown,
                   "Print every key with its meaning as Markdown (default: JSON Schema)");
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
                               arguments.stress.quiet || arguments.follow.quiet);
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
  if (program.got_subcommand("report")) return report_command(arguments.report);
  if (program.got_subcommand("follow")) return follow_command(arguments.follow);
  if (program.got_subcommand("completion")) return completion_command(program, arguments.completion);
  if (program.got_subcommand("man")) return man_command(program);
  return schema_command(arguments.schema);
}

ExitStatus no_thread() {
  spdlog::error("cannot start a thread: not enough memory, address space or processes (ulimit -v, ulimit -u)");
  return kUsage;
}

}  // namespace

int main(int argc, const char* const* argv) {
  start_log({}, false);
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
  } catch (const std::bad_alloc&) {
    spdlog::error("not enough memory; carousel check prints how much the configuration needs");
    return kUsage;
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

}  // namespace carousel::app
