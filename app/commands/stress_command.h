#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/run/prepare.h"

namespace carousel::app {

struct StressArguments : ConfigArguments {  // without a configuration the queues are tested by themselves
  std::vector<std::string> queues;          ///< names; empty: all
  std::vector<std::string> plugins;         ///< files; besides those of the configuration
  std::vector<std::string> patterns;        ///< names; empty: all
  std::vector<std::size_t> bytes;           ///< 8, 64, 256; empty: each pattern's own sizes
  std::string in = "topology.link.queue";   ///< the queue inside the ring, by the key of its design
  std::vector<std::int64_t> depths;         ///< inside the ring; empty: 1, the configuration's, and four times that
  double seconds = 30;
  std::uint64_t messages = 1'000'000;
  std::size_t repetitions = 3;
  std::size_t pairs = 12;  ///< pairs of runs of the best and the worst choice inside the ring
  std::size_t capacity = 64;
  std::uint64_t seed = 1;
  std::string out;  ///< folder; empty: out/stress, or out/<name of the configuration>
  bool json = false, quiet = false, force = false;
};

/// `carousel stress`: tests queue designs under load, by themselves and, with a configuration, inside its ring; prints
/// a table and writes stress.json and stress.html. Returns the exit status: 1 if a queue lost, duplicated, reordered or
/// corrupted a message, got stuck, or changed the results of a ring.
int stress_command(const StressArguments& arguments);

}  // namespace carousel::app
