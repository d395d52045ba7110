#pragma once

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/run/prepare.h"
#include "tests/app/keys/base_machines.h"
#include "tests/app/keys/key_rows.h"

namespace carousel {

struct KeyOutcome {
  using Json = nlohmann::ordered_json;
  std::string refusal;  ///< why the configuration was refused; empty if it was run
  std::string result;   ///< the report apart from the configuration, or the error that ended the run
  Json config;          ///< as it was run
};

/// The keys that have a value of their own.
std::vector<std::string> key_leaves();

/// The values that a row tries.
std::vector<std::string> values_of(const KeyRow& row);

/// Runs base machines as `carousel run` does.
class KeyRuns : public testing::Test {
 protected:
  KeyRuns() { write_scenes_and_rays(program_); }

  KeyOutcome run(BaseMachine machine, const std::vector<std::string>& sets);
  /// The arguments of a command on the machine.
  app::ConfigArguments arguments(BaseMachine machine, const std::vector<std::string>& sets);

  Program program_;
};

}  // namespace carousel
