#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/run/prepare.h"

namespace carousel::app {

struct StressArguments : ConfigArguments {  // without a configuration: the queues by themselves
  std::vector<std::string> queues;          ///< names; empty: all
  std::vector<std::string> patterns;        ///< names; empty: all
  std::vector<std::size_t> bytes;           ///< 8, 64, 256; empty: what each pattern wants
  std::vector<std::int64_t> depths;         ///< inside the ring; empty: some about the configuration's
  double seconds = 30;
  std::uint64_t messages = 1'000'000;
  std::size_t repetitions = 3;
  std::size_t capacity = 64;
  std::uint64_t seed = 1;
  std::string out;  ///< folder; empty: out/stress, or out/<name of the configuration>
  bool json = false, quiet = false;
};

/// `carousel stress`: queue designs under load, by themselves and, with a configuration, inside its ring; prints a
/// table, writes stress.json. Returns the exit status: 1 when a queue lost, doubled, reordered or tore a message, got
/// stuck, or changed what a ring computes.
int stress_command(const StressArguments& arguments);

}  // namespace carousel::app
