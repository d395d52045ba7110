#include <CLI/CLI.hpp>

#include "app/command_line/command_options.h"

namespace carousel::app {

void add_sweep_options(CLI::App& command, SweepArguments& s) {
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* help, const char* type) {
    command.add_option(name, values, help)->allow_extra_args(false)->type_name(type);
  };
  list("--vary", s.vary,
       "Values of a key: k=a,b,c, k=1..8, k=1..64*2, k=0..1:5, k=log:64..4096:7, or of several that vary together: "
       "k1,k2=(a,b),(c,d); may be repeated (default: vary of the configuration)",
       "KEY=VALUES");
  list("--exclude", s.exclude,
       "Leave out the points for which all conditions hold, e.g. topology.resources=64,memory.l2_kib<=128; may be "
       "repeated (default: none)",
       "CONDITIONS");
  list("--scene", s.scenes,
       "Scene, a glTF file or builtin:<name>; may be repeated (default: that of the configuration)", "SCENE");
  command
      .add_option("--points", s.points, "Number of points of a Latin hypercube over the keys (default: the whole grid)")
      ->check(CLI::Range(1u, 1'000'000u));
  command.add_option("--seed", s.seed, "Seed of the Latin hypercube")->capture_default_str();
  command.add_option("--repeat", s.repeat, "Repetitions of each point with image.seed one higher each")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command.add_option("--jobs", s.jobs, "Number of points that run at once (default: the machine's cores)")
      ->check(CLI::Range(1, 1024));
  CLI::Option* shard =
      command.add_option("--shard", s.shard, "Run part I of N of the points, without a ledger (default: all points)")
          ->type_name("I/N");
  list("--merge", s.merge,
       "Take over the finished points of another folder, and run nothing; may be repeated (default: none)", "DIR");
  command.get_option("--merge")->excludes(shard);
  list("--result", s.results,
       "Add a result by its path in the report, e.g. packets.latency.p99; may be repeated (default: cycles, rates, "
       "verdict, bytes, tests)",
       "PATH");
  command
      .add_option("--pareto", s.pareto,
                  "Find the Pareto front of two results, e.g. cycles,bytes; max: or min: before a name says what is "
                  "better (default: none)")
      ->type_name("A,B");
  command.add_flag("--sampled{0.1}", s.sampled,
                   "Simulate a part of each point's frame, --sampled=FRACTION or a tenth, and estimate the rest; with "
                   "--pareto run the points of the front whole after that (default: as configured)");
  command.add_option("--out", s.out, "Folder for the points and the results (default: out/<config name>)")
      ->type_name("DIR");
  command.add_flag("--dry-run", s.dry_run,
                   "Print the number of points and how long they will take; a first point is run for that if none is "
                   "finished (default: run them)");
  command.add_flag("--retry-failed", s.retry_failed, "Run points again that failed before (default: they stay failed)");
  CLI::Option* ask = command.add_flag(
      "--ask", s.ask,
      "Read points from standard input, a JSON object of keys and values a line (default: from --vary)");
  CLI::Option* tell = command.add_flag(
      "--tell", s.tell,
      "With --ask: print each point's row as a line of JSON as soon as it is finished (default: not printed)");
  ask->needs(tell);
  tell->needs(ask);
  command.add_flag("--json", s.json, "Print the result as JSON instead of a table (default: table)");
  command.add_flag("--quiet", s.quiet,
                   "Print errors only, and the result if --json is given (default: progress and table)");
}

}  // namespace carousel::app
