#include <fmt/format.h>

#include "app/command_line/command_options.h"
#include "app/command_line/common_options.h"

namespace carousel::app {

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
  accuracy
      ->add_option("--seeds", a.seeds,
                   "Number of seeds of the picture, by whose rays simulated machines are compared in pairs")
      ->check(CLI::Range(2, 64))
      ->capture_default_str();
  accuracy->add_option("--seed", a.seed, "Seed of the hard cases")->capture_default_str();
  accuracy->add_flag("--table", a.table,
                     "Print the tables of all levels, hard cases, spawn points and samples (default: five lines)");
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

}  // namespace carousel::app
