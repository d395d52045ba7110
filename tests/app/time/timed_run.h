#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/commands/run_command.h"
#include "tests/app/support/program.h"

namespace carousel {

/// Runs machines as `carousel run` does, from the text of their configuration.
class TimedRun : public testing::Test {
 protected:
  using Json = nlohmann::ordered_json;

  /// The report of a run on the cycle engine, without the search for the bottleneck. `trace`: the name of its timeline
  /// in the program's folder; empty: none.
  Json report(const std::string& machine, std::vector<std::string> sets = {}, const std::string& trace = "") {
    program_.write("machine.yaml", machine);
    app::RunArguments arguments;
    arguments.config = (program_.folder() / "machine.yaml").string();
    sets.insert(sets.begin(), {"engine.kind=cycle", "engine.what_if=false"});
    arguments.sets = std::move(sets);
    arguments.out = (program_.folder() / "out").string();
    if (!trace.empty()) arguments.trace.file = (program_.folder() / trace).string();
    arguments.quiet = arguments.force = arguments.no_html = true;
    app::run_command(arguments);
    return Json::parse(program_.read("out/report.json"));
  }

  /// The row of the ledger of bytes for one kind of message.
  static Json ledger_row(const Json& report, const std::string& what) {
    for (const Json& row : report["bytes"])
      if (row["what"] == what) return row;
    ADD_FAILURE() << what;
    return {{"bytes", 0}, {"messages", 0}};
  }
  static std::uint64_t bytes(const Json& report, const std::string& what) { return ledger_row(report, what)["bytes"]; }

  Program program_;
};

}  // namespace carousel
