#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel {

/// The report of a run of the configuration, which ends well.
inline nlohmann::ordered_json run_report(const Program& program, const std::string& config,
                                         const std::vector<std::string>& sets) {
  program.write("a.yaml", config);
  std::vector<std::string> words{"run", "a.yaml", "--quiet", "--force", "--out", "out"};
  add_sets(words, sets);
  const Outcome outcome = program.run(words);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return nlohmann::ordered_json::parse(program.read("out/report.json"));
}

}  // namespace carousel
