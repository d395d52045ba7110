#include "ringbus/ranks/compare_clocks.h"

#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <thread>

#include <fmt/format.h>

#include "core/system/error.h"

namespace carousel::ringbus {

namespace {

constexpr int kQuestions = 32;
// A rank that is asked waits longer than rank 0 does, which names the one that does not answer.
constexpr std::chrono::seconds kAnswer{5}, kQuestion{15};

/// Waits for the one word that a rank says now. Longer messages are what is left of a run whose ranks have parted.
std::uint64_t next_word(Transport& transport, std::uint32_t expected, std::chrono::seconds most) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + most;
  std::uint32_t from = 0;
  std::vector<std::uint64_t> words;
  while (!transport.receive(from, words) || words.size() != 1) {
    if (Clock::now() > until)
      throw SimulationError(
          fmt::format("rank {} has said nothing for {} seconds while clocks were compared; it hangs "
                      "or has died",
                      expected, most.count()));
    std::this_thread::yield();
  }
  return words[0];
}

void ask(Transport& transport, std::uint32_t rank, const std::function<std::int64_t()>& now, RankClock& best) {
  const std::array<std::uint64_t, 1> question{};
  const std::int64_t asked = now();
  transport.send(rank, question);
  const auto answer = static_cast<std::int64_t>(next_word(transport, rank, kAnswer));
  const std::int64_t half = (now() - asked + 1) / 2;
  if (static_cast<std::uint64_t>(half) < best.uncertainty)
    best = {answer - (asked + half), static_cast<std::uint64_t>(half)};
  transport.leaving(rank);  // lets go of messages that have left
}

}  // namespace

std::string clock_identity() {
  // Processes of one boot share CLOCK_MONOTONIC, unless they are in time namespaces of their own (time_namespaces(7)).
  std::string boot;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id") >> std::ws, boot);
  std::error_code none;
  const std::string space = std::filesystem::read_symlink("/proc/self/ns/time", none).string();
  return boot.empty() || none ? "" : boot + " " + space;
}

std::vector<RankClock> compare_clocks(Transport& transport, const std::string& identity,
                                      const std::function<std::int64_t()>& now) {
  const std::vector<std::string> all = transport.gather(identity);
  std::vector<RankClock> clocks(all.size());
  const auto differs = [&](std::uint32_t rank) { return rank != 0 && (all[rank].empty() || all[rank] != all[0]); };
  if (transport.rank() == 0) {
    for (std::uint32_t r = 0; r < all.size(); ++r)
      if (differs(r)) clocks[r].uncertainty = std::numeric_limits<std::uint64_t>::max();
    // Round by round, so that each is asked at different times.
    for (int i = 0; i < kQuestions; ++i)
      for (std::uint32_t r = 0; r < all.size(); ++r)
        if (differs(r)) ask(transport, r, now, clocks[r]);
  } else if (differs(transport.rank())) {
    for (int i = 0; i < kQuestions; ++i) {
      next_word(transport, 0, kQuestion);
      const std::array<std::uint64_t, 1> answer{static_cast<std::uint64_t>(now())};
      transport.send(0, answer);
    }
  }
  const std::string bytes = transport.gather(
      {reinterpret_cast<const char*>(clocks.data()), transport.rank() == 0 ? clocks.size() * sizeof clocks[0] : 0})[0];
  while (transport.leaving(0) > 0) std::this_thread::yield();  // they have come: rank 0 has read all answers
  std::memcpy(clocks.data(), bytes.data(), bytes.size());
  return clocks;
}

}  // namespace carousel::ringbus
