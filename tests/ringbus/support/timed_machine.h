#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/config/load/load.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {

/// The outcome of a small cycle machine that a user configures: `text` is YAML without scene and engine. Collections
/// get the storage that run_cell() chooses.
inline Outcome run_text(TestScene& scene, const std::string& text, const std::vector<std::string>& sets = {},
                        std::size_t threads = 1) {
  Cell cell;
  cell.config = load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\n" + text, "machine.yaml"}, sets).config;
  cell.threads = threads;
  Outcome out = run_cell(scene, cell);
  EXPECT_EQ(out.fault, "") << text;
  return out;
}

inline std::uint64_t cycles_of(TestScene& scene, const std::string& text, const std::vector<std::string>& sets = {}) {
  return run_text(scene, text, sets).result.cycle->cycles;
}

}  // namespace carousel::ringbus
