#include <fmt/format.h>

#include "app/command_line/command_options.h"
#include "app/command_line/common_options.h"

namespace carousel::app {

void add_run(CLI::App& program, RunArguments& r) {
  CLI::App* run = program.add_subcommand("run", "Simulate one configuration; write a report and the picture");
  add_config_options(*run, r);
  add_strict_option(*run, r);
  add_charge_all_option(*run, r);
  run->add_option("--out", r.out, "Folder for report and picture (default: out/<config name>)")->type_name("DIR");
  run->add_flag("--hits", r.hits, "Write hits.csv, one row per ray (default: not written)");
  run->add_option("--dump-rays", r.dump_rays,
                  "Write all rays as CSV, which workload: {rays_from: FILE} reads (default: not written)")
      ->type_name("FILE");
  run->add_option("--dump-trees", r.dump_trees,
                  "Write the trees over the meshes, which bvh.file reads (default: not written)")
      ->type_name("FILE");
  run->add_option("--dump-memory", r.dump_memory,
                  "Write the requests to the simulated memory as CSV, which workload: {memory_trace: FILE} reads "
                  "(default: not written)")
      ->type_name("FILE");
  run->add_option("--heat", r.heat,
                  "Draw what the rays of each pixel took, their cycles, tests, hops and waiting, on this scale: "
                  "heat_cycles.png and so on, and heat.csv (default: not drawn)")
      ->check(CLI::IsMember({"linear", "log"}))
      ->type_name("SCALE");
  run->add_flag(
      "--audit", r.audit,
      "With sampling.fraction: simulate the whole frame, too, and say how far off the estimates are (default: "
      "not simulated)");
  run->add_flag("--no-html", r.no_html, "Do not write report.html (default: written)");
  CLI::Option* trace =
      run->add_option("--trace", r.trace.file,
                      "Write a timeline of events that ui.perfetto.dev opens: Perfetto's protobuf if the name ends in "
                      ".pftrace, else JSON (default: not written)")
          ->type_name("FILE");
  run->add_option(
         "--trace-window", r.trace.window,
         "With --trace: only events that begin between these cycles, or seconds of a native run (default: all)")
      ->needs(trace)
      ->type_name("A:B");
  run->add_option("--trace-sample", r.trace.every,
                  "With --trace: only every N-th packet of each resource (default: as many as the most events allow)")
      ->needs(trace)
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}));
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

}  // namespace carousel::app
