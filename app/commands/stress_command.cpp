#include "app/commands/stress_command.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "app/host/output_folder.h"
#include "app/plugins/plugins.h"
#include "app/stress/ring_queues.h"
#include "core/config/config.h"
#include "core/config/write.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "core/text/edit_distance.h"
#include "core/types/added_names.h"
#include "report/html/studies/study_pages.h"
#include "report/read/document.h"
#include "report/run/report_json.h"
#include "report/stress/stress_table.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/native/links/link.h"
#include "ringbus/stress/expected.h"
#include "ringbus/stress/stress_run.h"

namespace carousel::app {

namespace {

namespace stress = ringbus::stress;

struct NamedQueue {
  QueueKind kind;
  std::string name;
};

/// The values with these names; all known values if no names are given. Throws ConfigError.
template <class Value, class Known>
std::vector<Value> chosen(const std::vector<std::string>& names, const char* option, const Known& known) {
  std::vector<Value> out;
  std::vector<std::string> spellings;
  for (const auto& [value, name] : known) spellings.emplace_back(name);
  if (names.empty())
    for (const auto& [value, name] : known) out.push_back(value);
  for (const std::string& name : names) {
    const auto at = std::find(spellings.begin(), spellings.end(), name);
    if (at == spellings.end()) {
      const auto near = nearest_name(name, spellings);
      throw ConfigError(option, fmt::format("expected one of {}, found {}{}", fmt::join(spellings, ", "), name,
                                            near ? "; did you mean " + *near + "?" : ""));
    }
    const auto& entry = *(std::begin(known) + (at - spellings.begin()));
    const auto& [value, spelling] = entry;
    out.push_back(value);
  }
  return out;
}

std::optional<report::StressLatency> latency_of(const LatencyHistogram& h) {
  if (h.count() == 0) return std::nullopt;
  const auto at = [&](double q) { return static_cast<double>(h.quantile(q)); };
  return report::StressLatency{at(0.5), at(0.99), at(0.999), static_cast<double>(h.max())};
}

report::StressRow row_of(const stress::StressRow& row, const stress::QueueUnderTest& queue, std::size_t capacity) {
  const stress::TrialResult& sum = row.sum;
  report::StressRow out;
  out.queue = queue.name;
  out.pattern = stress::pattern_name(row.pattern);
  out.message_bytes = row.message_bytes;
  out.capacity = row.pattern == stress::Pattern::kCapacity1   ? 1
                 : row.pattern == stress::Pattern::kCapacity2 ? 2
                                                              : capacity;
  out.threads = sum.threads;
  out.messages = sum.messages;
  out.rate_median = row.median();
  out.rate_least = row.least();
  out.rate_most = row.most();
  out.transit = latency_of(sum.transit_ns);
  out.round_trip = latency_of(sum.round_trip_ns);
  out.fairness = sum.fairness;
  out.push_refused = report::ratio(sum.push_refusals, sum.push_calls);
  out.pop_refused = report::ratio(sum.pop_refusals, sum.pop_calls);
  out.blocked = report::ratio(sum.blocked_seconds, sum.producer_seconds);
  out.memory_bytes = sum.memory_bytes;
  out.found = sum.violations.names();
  out.detail = sum.violations.detail;
  out.expected = stress::expected_of(queue.name, row.pattern, sum.violations);
  return out;
}

[[noreturn]] void unknown_place(const std::string& found) {
  std::vector<std::string> keys;
  for (const RingPlace& place : ring_places()) keys.emplace_back(place.key);
  const auto near = nearest_name(found, keys);
  throw ConfigError("--in", fmt::format("expected one of {}, found {}{}", fmt::join(keys, ", "), found,
                                        near ? "; did you mean " + *near + "?" : ""));
}

void require_sizes(const std::vector<std::size_t>& sizes) {
  for (const std::size_t bytes : sizes)
    if (bytes != stress::kSmall && bytes != stress::kLine && bytes != stress::kPacket)
      throw ConfigError(
          {{{},
            "--bytes",
            fmt::format("expected {}, {} or {}, found {}", stress::kSmall, stress::kLine, stress::kPacket, bytes)}});
}

/// The depths to test: shallow, as configured, and deep.
std::vector<std::int64_t> depths_about(const Config& config, const RingPlace& place) {
  const bool link = place.key == ring_places().front().key;
  const std::int64_t depth = place.depth(config);
  std::vector<std::int64_t> depths{link && config.topology.flow == Flow::kBubble ? 2 : 1, depth, 4 * depth};
  std::sort(depths.begin(), depths.end());
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  return depths;
}

}  // namespace

int stress_command(const StressArguments& arguments) {
  const InterruptScope interrupt;
  const auto start = std::chrono::steady_clock::now();
  std::vector<stress::Pattern> patterns = chosen<stress::Pattern>(arguments.patterns, "--pattern", stress::kPatterns);
  const auto place = std::find_if(ring_places().begin(), ring_places().end(),
                                  [&](const RingPlace& p) { return p.key == arguments.in; });
  if (place == ring_places().end()) unknown_place(arguments.in);
  require_sizes(arguments.bytes);
  std::filesystem::path folder = arguments.out;
  if (folder.empty())
    folder = std::filesystem::path("out") /
             (arguments.config.empty() ? "stress" : std::filesystem::path(arguments.config).stem());
  std::vector<QueueKind> kinds;
  std::vector<stress::QueueUnderTest> queues;
  std::vector<std::string> plugins = open_plugins(arguments.plugins);
  const auto choose_queues = [&] {
    std::vector<NamedQueue> known;
    for (const auto& [name, kind] : named_values<QueueKind>(plugins)) known.push_back({kind, name});
    kinds = chosen<QueueKind>(arguments.queues, "--queue", known);
    for (const QueueKind kind : kinds) queues.push_back(stress::named_queue(kind));
    for (const stress::Pattern pattern : patterns)
      if (std::none_of(queues.begin(), queues.end(),
                       [&](const auto& queue) { return stress::pattern_fits(queue, pattern); }) &&
          !arguments.patterns.empty())
        ringbus::require_parties(kinds[0], "--queue", ringbus::Parties::kMany, ringbus::Parties::kMany);
  };
  std::optional<OutputFolder> output;
  std::unique_ptr<const Prepared> prepared;
  if (!arguments.config.empty()) {
    prepared.reset(new Prepared(prepare(arguments, {}, false, [&](const Prepared& of) {
      for (const std::string& file : of.located.plugins)
        if (std::find(plugins.begin(), plugins.end(), file) == plugins.end()) plugins.push_back(file);
      choose_queues();
      const Config config = of.absolute_config();
      output.emplace(folder, &config, arguments.force, Results::kStress);
    })));
    if (prepared->config().workload.kind == WorkloadConfig::Kind::kTraffic ||
        prepared->config().workload.kind == WorkloadConfig::Kind::kMemoryTrace)
      throw ConfigError(
          {{prepared->located.positions.find("workload"), "workload", "stress tests queues with rays; expected rays"}});
  } else {
    choose_queues();
    output.emplace(folder, nullptr, arguments.force, Results::kStress);
  }

  std::optional<report::ProgressLine> line;
  std::uint64_t trials = 0;
  if (!arguments.quiet) line.emplace(stderr);
  report::Stress out;
  out.cores = std::max(1u, std::thread::hardware_concurrency());
  out.repetitions = arguments.repetitions;

  stress::StressOptions options;
  options.patterns = patterns;
  options.message_bytes = arguments.bytes;
  options.repetitions = arguments.repetitions;
  options.seconds = arguments.seconds;
  options.messages = arguments.messages;
  options.capacity = arguments.capacity;
  options.seed = arguments.seed;
  options.stop = interrupt.token();
  options.progress = [&](double part) {
    if (line) line->update(prepared ? part / 2 : part, ++trials, "trials", "queues");
  };
  for (const stress::StressRow& row : stress::run_stress(queues, options))
    if (!row.rates.empty()) out.rows.push_back(row_of(row, queues[row.queue], arguments.capacity));

  if (prepared && !interrupt.interrupted()) {
    const std::vector<std::int64_t> depths =
        arguments.depths.empty() ? depths_about(prepared->config(), *place) : arguments.depths;
    RingTrial trial{*place, kinds, depths, arguments.repetitions, arguments.pairs, interrupt.token()};
    // Only the kinds that serve as many threads as there may be are tried.
    if (arguments.queues.empty() && &*place != ring_places().data())
      std::erase_if(trial.kinds, [](QueueKind kind) {
        return !ringbus::queue_fits(kind, ringbus::Parties::kMany, ringbus::Parties::kMany);
      });
    out.ring_key = place->key;
    trial.progress = [&](double part) {
      if (line) line->update(0.5 + part / 2, ++trials, "trials", "ring");
    };
    RingTrialResult tried = try_in_ring(*prepared, trial);
    out.ring = std::move(tried.rows);
    if (tried.pairs) out.ring_verdict = ring_verdict(*tried.pairs);
    out.ring_pairs = std::move(tried.pairs);
  }
  line.reset();
  out.incomplete = interrupt.interrupted();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const nlohmann::ordered_json result = report::stress_json(out);
  const std::string json = report::sealed(result).dump(2) + "\n";
  const std::exception_ptr failure = output->write([&](const std::filesystem::path& staging) {
    if (prepared) write_file(staging / "config.resolved.yaml", resolved_yaml(prepared->absolute_config()));
    write_file(staging / "stress.html", report::html::stress_page(result));
    write_file(staging / "stress.json", json);
  });
  if (arguments.json)
    print_result(json);
  else if (!arguments.quiet)
    print_text(report::stress_table(out) + (failure
                                                ? "files: none, they cannot be written\n"
                                                : "files: " + (folder / "stress.json").string() + ", stress.html\n"));
  if (failure) std::rethrow_exception(failure);
  if (out.broken()) {
    std::string last;  // one message a queue and pattern; the table has the rest
    for (const report::StressRow& row : out.rows)
      if (!row.found.empty() && row.expected.empty() && std::exchange(last, row.queue) != row.queue)
        spdlog::error("{} under {}: {} ({})", row.queue, row.pattern, row.found, row.detail);
    return kBroken;
  }
  return out.incomplete ? interrupt.status() : kDone;
}

}  // namespace carousel::app
