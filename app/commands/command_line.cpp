#include "app/commands/command_line.h"

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "app/commands/accuracy_command.h"
#include "app/commands/certify_command.h"
#include "app/commands/check_command.h"
#include "app/commands/compare_command.h"
#include "app/commands/inspect_command.h"
#include "app/commands/run_command.h"
#include "app/commands/schema_command.h"
#include "app/commands/stress_command.h"
#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/host/version_text.h"
#include "core/config/edit_distance.h"
#include "core/system/error.h"

namespace carousel::app {

namespace {

const std::vector<std::string> kCommands{"run", "check", "stress", "accuracy", "inspect", "compare", "schema"};

void log_to_stderr(bool quiet) {
  // Replaces the logger, so that tests may call main() again.
  spdlog::drop("carousel");
  auto logger = spdlog::stderr_color_mt("carousel");
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(quiet ? spdlog::level::err : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return near ? fmt::format("; did you mean {}?", *near) : "";
}

/// What CLI11 has no words for: the nearest command or option.
std::string usage_hint(const CLI::App& program, int argc, const char* const* argv) {
  if (argc < 2) return fmt::format("expected a command: {}", fmt::join(kCommands, ", "));
  const std::string first = argv[1];
  const bool known = std::find(kCommands.begin(), kCommands.end(), first) != kCommands.end();
  if (!first.empty() && first[0] != '-' && !known)
    return fmt::format("unknown command {}{}; known are {}", first, did_you_mean(first, kCommands),
                       fmt::join(kCommands, ", "));
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
  AccuracyArguments accuracy;
  RunArguments run;
  StressArguments stress;
  CheckArguments check;
  InspectArguments inspect;
  CompareArguments compare;
  SchemaArguments schema;
};

void add_config_options(CLI::App& command, ConfigArguments& arguments, bool required = true) {
  command.add_option("config", arguments.config, "configuration, YAML or JSON")->required(required);
  command.add_option("--set", arguments.sets, "key.path=value: set a key of the configuration; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
}

void add_commands(CLI::App& program, Arguments& arguments) {
  program.require_subcommand(1);
  program.set_version_flag("--version", version_text);

  CLI::App* run = program.add_subcommand("run", "one simulation");
  RunArguments& r = arguments.run;
  add_config_options(*run, r);
  run->add_option("--out", r.out, "folder for report and picture (default out/<config name>)")->type_name("DIR");
  run->add_flag("--hits", r.hits, "write hits.csv, one row a ray");
  run->add_option("--dump-rays", r.dump_rays, "write all rays as CSV, to be read by workload: {rays_from: FILE}")
      ->type_name("FILE");
  run->add_flag("--json", r.json, "print the report as JSON instead of the table");
  run->add_flag("--quiet", r.quiet, "print nothing but errors (and the report with --json)");
  run->add_flag("--force", r.force, "run although the topology can deadlock");

  CLI::App* check = program.add_subcommand("check", "validate, print the resolved config, say whether it can deadlock");
  add_config_options(*check, arguments.check);

  CLI::App* stress = program.add_subcommand("stress", "queue designs under load: loss, order, throughput, latency");
  StressArguments& s = arguments.stress;
  add_config_options(*stress, s, false);
  stress->add_option("--queue", s.queues, "kinds to try, as topology.link.queue (default all)")
      ->delimiter(',')
      ->type_name("KIND");
  stress->add_option("--pattern", s.patterns, "patterns to try (default all)")->delimiter(',')->type_name("PATTERN");
  stress->add_option("--bytes", s.bytes, "size of a message: 8, 64, 256 (default what each pattern wants)")
      ->delimiter(',');
  stress
      ->add_option("--depths", s.depths,
                   "with a configuration: depths of links to try (default 1, its own, four times its own)")
      ->delimiter(',')
      ->check(CLI::Range(1, 1'000'000));
  stress->add_option("--seconds", s.seconds, "for the queues by themselves, in all")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  stress->add_option("--messages", s.messages, "of one trial, at most")
      ->check(CLI::Range(1u, 100'000'000u))
      ->capture_default_str();
  stress->add_option("--repetitions", s.repetitions, "of each trial, in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  stress->add_option("--capacity", s.capacity, "of a queue by itself")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  stress->add_option("--seed", s.seed, "of pauses")->capture_default_str();
  stress->add_option("--out", s.out, "folder for stress.json (default out/stress, or out/<config name>)")
      ->type_name("DIR");
  stress->add_flag("--json", s.json, "print JSON instead of the table");
  stress->add_flag("--quiet", s.quiet, "print nothing but errors (and the results with --json)");

  CLI::App* accuracy = program.add_subcommand("accuracy", "what accuracy costs in time");
  AccuracyArguments& a = arguments.accuracy;
  add_config_options(*accuracy, a, false);
  accuracy->add_option("--out", a.out, "folder for table and picture (default out/<config name>)")->type_name("DIR");
  accuracy->add_option("--rays", a.rays, "rays of the scene to compare, at most")
      ->check(CLI::Range(1u, 10'000'000u))
      ->capture_default_str();
  accuracy->add_option("--hard-rays", a.hard_rays, "rays of each built-in hard case")
      ->check(CLI::Range(1u, 10'000'000u))
      ->capture_default_str();
  accuracy->add_option("--repetitions", a.repetitions, "of each timing, in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  accuracy->add_option("--seed", a.seed, "of the hard cases")->capture_default_str();
  accuracy->add_flag("--json", a.json, "print JSON instead of the table");
  accuracy->add_flag("--quiet", a.quiet, "print nothing but errors (and the results with --json)");

  CLI::Option* certify = accuracy->add_flag(
      "--certify", a.certify, "try hard cases of what the levels promise instead; a configuration chooses one level");
  CLI::Option* cases = accuracy->add_option("--cases", a.cases, "with --certify: of each property")->needs(certify);
  accuracy->add_option("--seconds", a.seconds, "with --certify: until then")
      ->check(CLI::PositiveNumber)
      ->needs(certify)
      ->excludes(cases)
      ->capture_default_str();
  accuracy->add_option("--reproduce", a.reproduce, "try one case again, as --certify prints it, or those in a file")
      ->excludes(certify)
      ->type_name("CASE");

  CLI::App* inspect = program.add_subcommand("inspect", "what a scene holds and which effects it calls for");
  inspect->add_option("scene", arguments.inspect.scene, "glTF file, or builtin:<name>")->required();
  inspect->add_option("--set", arguments.inspect.sets, "key.path=value: as for run, e.g. shading.effects=all")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  inspect->add_flag("--json", arguments.inspect.json, "print JSON instead of the table");

  CLI::App* compare = program.add_subcommand("compare", "two reports side by side");
  compare->add_option("a", arguments.compare.a, "report.json, or its folder")->required();
  compare->add_option("b", arguments.compare.b, "the other")->required();
  compare->add_option("--expect", "identical: exit status 1 when they differ")
      ->check(CLI::IsMember({"identical"}))
      ->each([&arguments](const std::string&) { arguments.compare.expect_identical = true; });

  CLI::App* schema = program.add_subcommand("schema", "JSON Schema of the files");
  schema->add_option("file", arguments.schema.file, "config or report")
      ->required()
      ->check(CLI::IsMember({"config", "report"}));
  schema->add_flag("--markdown", arguments.schema.markdown, "config only: every key as a Markdown table");
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
    spdlog::error("{}\ncarousel --help tells the usage", hint.empty() ? error.what() : hint);
    return kUsage;
  }
  log_to_stderr(arguments.run.quiet || arguments.accuracy.quiet || arguments.stress.quiet);
  if (program.got_subcommand("run")) return run_command(arguments.run);
  if (program.got_subcommand("stress")) return stress_command(arguments.stress);
  if (program.got_subcommand("check")) return check_command(arguments.check);
  if (program.got_subcommand("accuracy")) {
    const AccuracyArguments& accuracy = arguments.accuracy;
    if (accuracy.certify) return certify_command(accuracy);
    return accuracy.reproduce.empty() ? accuracy_command(accuracy) : reproduce_command(accuracy);
  }
  if (program.got_subcommand("inspect")) return inspect_command(arguments.inspect);
  if (program.got_subcommand("compare")) return compare_command(arguments.compare);
  return schema_command(arguments.schema);
}

}  // namespace

int main(int argc, const char* const* argv) {
  log_to_stderr(false);
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
    spdlog::error("not enough memory; carousel check says what the configuration needs");
    return kUsage;
  } catch (const SimulationError& error) {
    spdlog::error("{}", error.what());
    return kBroken;
  } catch (const std::exception& error) {
    spdlog::error("internal error: {}", error.what());
    return kBroken;
  }
}

}  // namespace carousel::app
