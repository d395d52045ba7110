#include "app/commands/sweep_command.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "app/sweep/ask_tell.h"
#include "app/sweep/folder_lock.h"
#include "app/sweep/plan/design.h"
#include "app/sweep/sampled_sweep.h"
#include "app/sweep/sweep_files.h"
#include "app/sweep/sweep_run.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "core/system/unfinished.h"
#include "report/html/studies/sweep_page.h"
#include "report/read/document.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::app {

namespace {

[[noreturn]] void usage(const std::string& option, const std::string& message) {
  throw ConfigError({{{option, 0, 0}, "", message}});
}

struct Shard {
  std::size_t part = 0, of = 1;  ///< part counts from 0
};

Shard parse_shard(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t slash = text.find('/');
  const auto part = number_of(text.substr(0, slash)), of = number_of(slash == text.npos ? "" : text.substr(slash + 1));
  if (!part || !of || *part < 1 || *part > *of || *of > 100'000)
    usage("--shard " + text, "expected I/N with I from 1 to N, as in 3/8");
  return {static_cast<std::size_t>(*part) - 1, static_cast<std::size_t>(*of)};
}

std::vector<Axis> axes_of(const SweepArguments& arguments, const Config& config) {
  std::vector<Axis> axes;
  if (!arguments.scenes.empty()) axes.push_back(scene_axis(arguments.scenes));
  std::vector<Axis> given;
  for (const std::string& text : arguments.vary) given.push_back(parse_axis(text));
  const auto names = [](const Axis& axis, const std::string& key) {
    return std::find(axis.keys.begin(), axis.keys.end(), key) != axis.keys.end();
  };
  // The command line goes before the file, key by key.
  for (const auto& [keys, values] : config.vary) {
    Axis axis = make_axis(keys, values, arguments.config + ": vary");
    const bool replaced = std::any_of(given.begin(), given.end(), [&](const Axis& other) {
      return std::any_of(axis.keys.begin(), axis.keys.end(), [&](const std::string& key) { return names(other, key); });
    });
    if (!replaced) axes.push_back(std::move(axis));
  }
  axes.insert(axes.end(), given.begin(), given.end());
  if (arguments.repeat > 1) {
    Axis seeds{{"image.seed"}, {}, {}};
    for (std::int64_t i = 0; i < arguments.repeat; ++i) seeds.levels.push_back({std::to_string(config.image.seed + i)});
    axes.push_back(std::move(seeds));
  }
  if (!arguments.sampled.empty()) {
    const auto fraction = number_of(arguments.sampled);
    if (!fraction || !(*fraction > 0 && *fraction < 1))
      usage("--sampled=" + arguments.sampled, "expected a number above 0 and below 1");
    axes.push_back({{kSampledKey}, {{arguments.sampled}}, {}});
  }
  std::vector<std::string> keys;
  for (const Axis& axis : axes)
    for (const std::string& key : axis.keys) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end())
        usage("--vary", fmt::format("expected each key once, found {} twice", key));
      keys.push_back(key);
    }
  return axes;
}

std::vector<Choice> choices_of(const SweepArguments& arguments, std::vector<Axis> axes) {
  std::vector<Exclusion> exclusions;
  for (const std::string& text : arguments.exclude) exclusions.push_back(parse_exclusion(text, axes));
  std::vector<Choice> out;
  if (arguments.points) {
    // Repetitions and scenes are no dimensions of the hypercube: each of its points is run with all of them.
    std::vector<Axis> before, drawn, after;
    for (Axis& axis : axes)
      (axis.keys[0] == "scene" ? before : axis.keys[0] == "image.seed" ? after : drawn).push_back(std::move(axis));
    const std::vector<Choice> cube = latin_hypercube(drawn, *arguments.points, arguments.seed);
    for (const Choice& scene : grid(before))
      for (const Choice& point : cube)
        for (const Choice& seed : grid(after)) {
          Choice choice = scene;
          choice.insert(choice.end(), point.begin(), point.end());
          choice.insert(choice.end(), seed.begin(), seed.end());
          out.push_back(std::move(choice));
        }
  } else {
    out = grid(axes);
  }
  std::erase_if(out, [&](const Choice& choice) {
    return std::any_of(exclusions.begin(), exclusions.end(), [&](const Exclusion& e) { return e.holds(choice); });
  });
  if (out.empty()) usage("--exclude", "leaves no point");
  return out;
}

std::size_t terminal_width() {
  if (const char* columns = std::getenv("COLUMNS"); columns != nullptr && std::atoi(columns) > 20)
    return static_cast<std::size_t>(std::atoi(columns));
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20) return size.ws_col;
  return 120;
}

std::filesystem::path out_folder(const SweepArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  return std::filesystem::path("out") / std::filesystem::path(arguments.config).stem();
}

/// Copies the finished points of other folders that belong to this sweep and are missing here.
void merge(const SweepArguments& arguments, const SweepSetup& setup, SweepRows& rows) {
  for (const std::string& folder : arguments.merge) {
    if (std::error_code ignored; !std::filesystem::is_directory(std::filesystem::path(folder) / "points", ignored))
      throw FileError("cannot merge " + folder + ": it holds no folder of points");
    for (SweepRow& row : rows.rows) {
      if (row.finished) continue;
      const std::filesystem::path from = point_path(folder, row.point.digest);
      std::error_code missing;
      if (!std::filesystem::exists(from, missing)) continue;
      const std::optional<PointFile> file = read_point(from);
      if (!file) continue;
      write_point(setup.out, row.point, file->seconds, file->error, file->report);
      fill_row(row, rows.columns, *file);
    }
  }
}

double mean_seconds(const SweepRows& rows) {
  double seconds = 0;
  for (const SweepRow& row : rows.rows)
    if (row.finished && !row.error) seconds += row.seconds;
  return rows.done() == 0 ? 0 : seconds / static_cast<double>(rows.done());
}

std::string counts_text(const SweepRows& rows) {
  const std::size_t missing = rows.rows.size() - rows.done() - rows.failed();
  return fmt::format("{}: {} done, {} failed, {} to run", report::singular(fmt::format("{} points", rows.rows.size())),
                     rows.done(), rows.failed(), missing);
}

/// Prints the number of points and the time they take, by the finished ones or by a first one, which is run and kept.
int dry_run(const SweepSetup& setup, const SweepOptions& options, SweepRows& rows, const InterruptScope& interrupt) {
  read_finished(setup, rows, options.retry_failed);
  std::string source = rows.done() == 1 ? "1 finished point" : fmt::format("{} finished points", rows.done());
  if (rows.done() == 0) {
    const auto next =
        std::find_if(rows.rows.begin(), rows.rows.end(), [](const SweepRow& row) { return !row.finished; });
    if (next != rows.rows.end()) {
      const FolderLock lock(setup.out, "sweep.lock");
      SweepRows pilot{rows.keys, rows.columns, {*next}};
      run_missing(setup, options, pilot, nullptr, interrupt);
      *next = pilot.rows[0];
      source = "a first point, which was run and is kept";
    }
  }
  if (interrupt.interrupted()) return interrupt.status();
  const double left = static_cast<double>(rows.rows.size() - rows.done() - rows.failed());
  std::string time = "unknown, as the point that was tried failed";
  if (rows.done() > 0)
    time = fmt::format("about {} with {} at once, by {}",
                       report::seconds_text(left * mean_seconds(rows) / static_cast<double>(options.jobs)),
                       options.jobs, source);
  print_result(fmt::format("{}\ntime         {}\n", counts_text(rows), time));
  return kDone;
}

void log_failures(const SweepRows& rows) {
  constexpr std::size_t kShown = 5;
  std::size_t shown = 0;
  for (const SweepRow& row : rows.rows)
    if (row.error && ++shown <= kShown)
      spdlog::error("the point {} failed: {}: {}", row.point.text(), row.error->kind, row.error->text);
  if (shown > kShown)
    spdlog::error("{}", report::singular(fmt::format("{} more points failed; sweep.csv has all", shown - kShown)));
  if (shown > 0) spdlog::error("failed points run again with --retry-failed");
}

int finish(const SweepRows& rows, const InterruptScope& interrupt) {
  log_failures(rows);
  const std::size_t missing = rows.rows.size() - rows.done() - rows.failed();
  if (interrupt.interrupted()) {
    spdlog::warn("interrupted with {} of {} points finished; the same command goes on with the other {}",
                 rows.rows.size() - missing, rows.rows.size(), missing);
    return interrupt.status();
  }
  if (missing > 0)
    spdlog::error("{} missing; the same command without --merge runs what is missing",
                  missing == 1 ? "1 point is" : fmt::format("{} points are", missing));
  return missing > 0 || rows.failed() > 0 ? kBroken : kDone;
}

/// Writes and prints the results.
void give_results(const SweepArguments& arguments, const SweepSetup& setup, SweepRows rows, bool write, bool print) {
  std::vector<std::string> asked = arguments.results;
  if (!arguments.pareto.empty())
    for (const Goal& goal : parse_goals(rows, arguments.pareto)) asked.push_back(rows.columns[goal.column].name);
  rows.drop_empty(asked);
  const std::vector<Goal> goals = arguments.pareto.empty() ? std::vector<Goal>{} : parse_goals(rows, arguments.pareto);
  const nlohmann::ordered_json sweep = sweep_json(rows, goals, arguments.config);
  const std::string json = report::sealed(sweep).dump(1) + "\n";
  if (write) {
    write_file(setup.out / "sweep.csv", sweep_csv(rows));
    write_file(setup.out / "sweep.json", json);
    write_file(setup.out / "sweep.html", report::html::sweep_page(sweep, setup.out.string()));
  }
  if (!print) return;
  if (arguments.json)
    print_result(json);
  else if (!arguments.quiet)
    print_result(sweep_table(rows, goals, terminal_width()) + "\n" + counts_text(rows) + "\nfiles        " +
                 setup.out.string() + "\n");
}

/// The points come from another program (--ask, --tell).
int ask_command(const SweepArguments& arguments, const SweepSetup& setup, const SweepOptions& options, SweepRows rows,
                const InterruptScope& interrupt) {
  if (!arguments.vary.empty() || !arguments.shard.empty() || !arguments.merge.empty() || arguments.points)
    usage("--ask", "takes its points from standard input; expected no --vary, --points, --shard and --merge");
  PointMaker maker(setup.source, setup.config.parent_path(), arguments.sets);
  const FolderLock lock(setup.out, "sweep.lock");
  remove_abandoned(setup.out / "points");
  Ledger ledger(setup.out);
  ask_and_tell(setup, options, maker, rows, ledger, interrupt);
  if (!rows.rows.empty()) give_results(arguments, setup, rows, true, false);
  return finish(rows, interrupt);
}

}  // namespace

int sweep_command(const SweepArguments& arguments) {
  const InterruptScope interrupt;
  SweepSetup setup{arguments.config, read_config_file(arguments.config), out_folder(arguments)};
  const Config base = load_config(setup.source, arguments.sets, {.fields_only = true}).config;
  const Shard shard = parse_shard(arguments.shard);
  SweepOptions options{arguments.jobs, arguments.quiet, arguments.retry_failed};
  if (options.jobs == 0) options.jobs = std::max(1u, std::thread::hardware_concurrency());

  SweepRows rows{{}, result_columns(arguments.results), {}};
  if (arguments.ask) return ask_command(arguments, setup, options, std::move(rows), interrupt);

  const std::vector<Axis> axes = axes_of(arguments, base);
  for (const Axis& axis : axes) rows.keys.insert(rows.keys.end(), axis.keys.begin(), axis.keys.end());
  if (!arguments.pareto.empty())
    for (const Goal& goal : parse_goals(rows, arguments.pareto))
      rows.require_result(goal.column, base, "--pareto " + arguments.pareto);
  PointMaker maker(setup.source, setup.config.parent_path(), arguments.sets);
  std::vector<SweepPoint> points = make_points(maker, choices_of(arguments, axes));
  for (std::size_t i = shard.part; i < points.size(); i += shard.of)
    rows.rows.push_back({std::move(points[i]), false, {}, 0, {}});
  if (arguments.dry_run) return dry_run(setup, options, rows, interrupt);

  const bool sharded = shard.of > 1;
  const FolderLock lock(setup.out,
                        sharded ? fmt::format("shard-{}-of-{}.lock", shard.part + 1, shard.of) : "sweep.lock");
  remove_abandoned(setup.out / "points");
  read_finished(setup, rows, options.retry_failed);
  std::optional<Ledger> ledger;
  if (!sharded) ledger.emplace(setup.out);
  if (!arguments.merge.empty()) merge(arguments, setup, rows);
  if (ledger) record(*ledger, rows);
  if (arguments.merge.empty()) run_missing(setup, options, rows, ledger ? &*ledger : nullptr, interrupt);
  if (!arguments.sampled.empty() && !arguments.pareto.empty() && !sharded && arguments.merge.empty())
    run_front_whole(setup, options, maker, arguments.pareto, rows, &*ledger, interrupt);
  give_results(arguments, setup, rows, !sharded, true);
  return finish(rows, interrupt);
}

}  // namespace carousel::app
