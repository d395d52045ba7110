#include "app/usage/examples.h"

#include <fmt/format.h>

#include "app/host/exit_status.h"

namespace carousel::app {

const std::vector<Example>& examples() {
  static const std::vector<Example> list{
      {"run", "carousel run configs/demo.yaml", "a picture and a report, in out/demo"},
      {"run",
       "carousel run configs/demo.yaml --set engine.kind=cycle --set image.samples=1 --set "
       "rays.slots_per_resource=1024 --out out/cycle",
       "the same ring with fewer ray slots, under virtual time: cycles, and the parts that limit it"},
      {"run", "carousel run configs/demo.yaml --set scene='{file: my.glb}' --out out/mine", "a scene of your own"},
      {"compare", "carousel compare out/demo out/cycle", "the numbers of two runs side by side"},
      {"versus", "carousel versus configs/ring_distributed.yaml",
       "the machine against stacks in warps: faster or slower, by how much, and why"},
      {"sweep", "carousel sweep configs/sweep.yaml --vary topology.link.bytes_per_cycle=4..64*2",
       "many machines, a table of results"},
      {"sweep", "carousel sweep configs/sweep.yaml --dry-run", "how many points there are and how long they take"},
      {"check", "carousel check configs/demo.yaml",
       "all values with their defaults, the memory needed, deadlock rules"},
      {"check", "carousel check configs/demo.yaml --json --strict", "the same for a program; warnings are errors"},
      {"check", "carousel check configs/demo.yaml --set topology.flow=none", "a machine that can deadlock: refused"},
      {"stress", "carousel stress --queue spsc_ring,mutex --pattern stream", "two queue designs under one load"},
      {"accuracy", "carousel accuracy configs/demo.yaml", "time and errors of each level of accuracy"},
      {"accuracy", "carousel accuracy --certify --seconds 10", "the promises of the levels, judged exactly"},
      {"inspect", "carousel inspect my.glb", "contents of a scene, and the effects that it calls for"},
      {"inspect", "carousel inspect my.glb --frame Chair", "a camera that sees this node"},
      {"follow", "carousel follow configs/demo.yaml --pixel 320,200", "the life of one ray"},
      {"report", "carousel report out/demo", "the page of a run, again"},
      {"serve", "carousel serve out", "all results below a folder as one site on this machine"},
      {"schema", "carousel schema config --markdown", "every key with its meaning"},
      {"completion", "source <(carousel completion bash)", "completion in this shell"},
      {"man", "carousel man | man -l -", "the manual of this program"},
  };
  return list;
}

std::string first_steps() {
  std::string out = "First steps:\n";
  for (const char* command : {"run", "check", "sweep", "compare"}) {
    for (const Example& example : examples()) {
      if (example.command != command) continue;
      out += fmt::format("  {}\n      {}\n", example.line, example.meaning);
      break;
    }
  }
  return out +
         "\ncarousel COMMAND --help describes the options of a command and shows examples.\n"
         "The tutorial is docs/guides/tutorial.md; every key stands in docs/reference/config, every number of\n"
         "a report in docs/reference/report. An installation has docs in share/doc/carousel and configs in "
         "share/carousel.";
}

std::string examples_text(const std::string& command) {
  std::string out;
  for (const Example& example : examples())
    if (example.command == command)
      out += fmt::format("{}  {}\n      {}", out.empty() ? "Examples:\n" : "\n", example.line, example.meaning);
  return out;
}

const std::vector<StatusMeaning>& exit_statuses() {
  static const std::vector<StatusMeaning> list{
      {kDone, "The command has done its work."},
      {kBroken, "An invariant broke, a verification failed, or points of a sweep failed."},
      {kUsage, "The command line, the configuration, the scene or a file is wrong."},
      {kHungUp, "SIGHUP ended the run; its report is marked as incomplete."},
      {kInterrupted, "SIGINT (Ctrl-C) ended the run, likewise."},
      {kTerminated, "SIGTERM ended the run, likewise."},
  };
  return list;
}

}  // namespace carousel::app
