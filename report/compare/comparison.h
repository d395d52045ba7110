#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/run/report_difference.h"

namespace carousel::report {

/// A report that is compared, by the name that the user gave.
struct ComparedRun {
  std::string name;
  nlohmann::ordered_json report;
};

/// A number of all runs. A run that does not have it has no value.
struct ComparedRow {
  std::string name, unit;
  std::vector<std::optional<double>> values;  ///< by run
  std::vector<std::optional<double>> ratios;  ///< ratio of each value to the first run's; that of the first is 1
  bool of_cycles = false;                     ///< it follows from the cycles of the run, and has their noise
};

/// Rows that belong together: throughput, a ledger, memory.
struct ComparedSection {
  std::string name;
  std::vector<ComparedRow> rows;
};

/// A text of all runs; empty where a run does not have it.
struct ComparedText {
  std::string name;
  std::vector<std::string> texts;
};

/// Reports side by side. The first is the one that the others are compared with.
struct Comparison {
  std::vector<std::string> runs;              ///< names
  std::vector<bool> same_hits, same_picture;  ///< by run, as in the first; true where neither has any
  bool same_configuration = false;            ///< apart from the number of host threads
  bool deterministic = true;                  ///< every run was; otherwise counts and times may differ from run to run
  bool identical = false;                     ///< everything outside of `host` is equal
  /// By run: the part by which its cycles and those of the first may differ for another seed of the picture, by the
  /// noise of both or of the one that knows it. Absent for the first, where neither knows it, and where they differ by
  /// more.
  std::vector<std::optional<double>> within_noise;
  std::vector<ComparedText> texts;  ///< the verdict
  std::vector<ComparedSection> sections;
  std::vector<ComparedText> configuration;  ///< the keys that differ
  std::vector<ComparedText> differences;    ///< all other values outside of `host` that differ, by their path
  std::size_t keys_hidden = 0;              ///< keys that differ and that the pattern leaves out of `configuration`
  std::size_t values_hidden = 0;            ///< likewise of `differences`
};

/// Compares two runs or more. With a pattern only rows and keys stay whose name, or whose section's, contains it, in
/// any case; `*` in it stands for any characters.
Comparison compare_runs(const std::vector<ComparedRun>& runs, const std::string& only = "");

nlohmann::ordered_json comparison_json(const Comparison& comparison, bool all);

/// The name of a run in tables: A to Z, and from there on its number.
std::string letter(std::size_t run);

/// The words about a run whose cycles are within the noise of the first run's, without a full stop.
std::string noise_words(const Comparison& comparison, std::size_t run);

/// For a terminal: first whether the answers are the same, then numbers side by side, then the configuration; with
/// `all` every value that differs.
std::string comparison_table(const Comparison& comparison, bool all);

}  // namespace carousel::report
