#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace carousel::ringbus {

/// A rank from which nothing has come for so long has died or hangs. Far longer than a busy host keeps a thread waiting
/// that wants to run a moment.
inline constexpr std::chrono::seconds kRankSilence{5};

/// Brings bytes from process to process. The processes of a run are its ranks, 0 to ranks() - 1. One thread at a time
/// may call, not always the same.
class Transport {
 public:
  virtual ~Transport() = default;

  virtual std::uint32_t rank() const = 0;
  virtual std::uint32_t ranks() const = 0;

  // Messages while a run lasts. Two from one rank to another arrive in the order in which they were sent.

  /// Sends a copy of `words` to another rank. Does not wait.
  virtual void send(std::uint32_t to, std::span<const std::uint64_t> words) = 0;
  /// Messages to a rank that have not left yet.
  virtual std::size_t leaving(std::uint32_t to) = 0;
  /// Takes a message that has come, if there is one: returns true, and writes its sender and its words.
  virtual bool receive(std::uint32_t& from, std::vector<std::uint64_t>& words) = 0;

  // Calls that every rank makes, in the same order; they wait for one another, and throw a SimulationError where they
  // would wait for a rank that has died or hangs.

  /// Returns everyone's bytes, by rank.
  virtual std::vector<std::string> gather(const std::string& bytes) = 0;
  /// Adds up, number by number, modulo 2^64, what all ranks have in `numbers`. Rank 0 gets the sums; others keep
  /// theirs.
  virtual void sum(std::span<std::uint64_t> numbers) = 0;
};

}  // namespace carousel::ringbus
