#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/command_line/command_options.h"
#include "app/command_line/common_options.h"
#include "app/stress/ring_queues.h"
#include "core/config/fields/queue_kind.h"
#include "ringbus/stress/pattern.h"

namespace carousel::app {

namespace {

/// Names the values of a list in the help and for completion. The command judges them, and knows the nearest name.
CLI::Validator one_of(const std::vector<std::string_view>& names) {
  return CLI::Validator([](std::string&) { return std::string(); }, fmt::format("{{{}}}", fmt::join(names, ",")));
}
std::vector<std::string_view> names_of(const auto& table) {
  std::vector<std::string_view> names;
  names.reserve(table.size());
  for (const auto& entry : table) names.push_back(entry.name);
  return names;
}

}  // namespace

void add_stress_options(CLI::App& command, StressArguments& s) {
  command
      .add_option("--queue", s.queues,
                  "Kinds of queue to test, comma-separated, as in topology.link.queue (default: all)")
      ->delimiter(',')
      ->check(one_of(names_of(kEnumNames<QueueKind>)))
      ->type_name("KIND");
  add_plugin_option(command, s.plugins, "those of the configuration");
  command.add_option("--pattern", s.patterns, "Load patterns to test, comma-separated (default: all)")
      ->delimiter(',')
      ->check(one_of(names_of(ringbus::stress::kPatterns)))
      ->type_name("PATTERN");
  command.add_option("--bytes", s.bytes, "Message sizes in bytes, of 8, 64 and 256 (default: chosen by the pattern)")
      ->delimiter(',')
      ->type_name("BYTES");
  std::vector<std::string_view> places;
  for (const RingPlace& place : ring_places()) places.push_back(place.key);
  command.add_option("--in", s.in, "The queue of the configuration's ring to test designs and depths in, by its key")
      ->check(one_of(places))
      ->type_name("KEY")
      ->capture_default_str();
  command
      .add_option("--depths", s.depths,
                  "Depths in packets, batches or groups to test in the configuration's ring (default: 1, its own "
                  "depth, and four times that)")
      ->delimiter(',')
      ->check(CLI::Range(1, 65536))
      ->type_name("PLACES");
  command.add_option("--seconds", s.seconds, "Total time in seconds for tests of queues by themselves")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--messages", s.messages, "Most messages in one trial")
      ->check(CLI::Range(1u, 100'000'000u))
      ->capture_default_str();
  command.add_option("--repetitions", s.repetitions, "Number of times each trial is repeated")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      .add_option("--pairs", s.pairs,
                  "Number of pairs of runs that compare the best and the worst queue and depth in the "
                  "configuration's ring; fewer than 8 show no difference")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command.add_option("--capacity", s.capacity, "Capacity in messages of a queue tested by itself")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command.add_option("--seed", s.seed, "Seed of the random pauses between messages")->capture_default_str();
  command
      .add_option("--out", s.out, "Folder for stress.json and stress.html (default: out/stress, or out/<config name>)")
      ->type_name("DIR");
  command.add_flag("--json", s.json, "Print the result as JSON instead of a table (default: table)");
  command.add_flag("--quiet", s.quiet,
                   "Print errors only, and the result if --json is given (default: progress and table)");
  command.add_flag("--force", s.force, "Replace the results of another configuration in the folder (default: refused)");
}

}  // namespace carousel::app
