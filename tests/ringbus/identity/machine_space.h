#pragma once

#include <cstddef>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/ringbus/identity/factor.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {

/// A level of each factor, by its number in Factor::values; kAbsent where the machine does not read the key.
using Row = std::vector<int>;
inline constexpr int kAbsent = -1;

/// The levels that each factor may still take, ascending.
using Domains = std::vector<std::vector<int>>;

/// The machines that a list of factors spans. A user's way in decides which of them there are: a row becomes the text
/// of a configuration, and the program's reader and validator take or refuse it. From each refusal the space learns
/// which levels together are refused, so that the validator is asked seldom.
class MachineSpace {
 public:
  explicit MachineSpace(std::vector<Factor> factors);

  const std::vector<Factor>& factors() const { return factors_; }
  /// Every level, or those that `with` leaves: `key=value` or `key!=value`, and the conditions of these keys. Empty if
  /// no row has them all.
  Domains domains(std::span<const std::string> with = {}) const;
  /// The domains of rows with these levels of these factors.
  Domains domains_of_pair(std::size_t f, int a, std::size_t g, int b) const;

  /// A machine drawn from the domains, or nothing if the validator refuses every one.
  std::optional<Row> draw(std::mt19937& random, Domains domains);
  /// Draws without regard to the validator.
  Row draw_any(std::mt19937& random, const Domains& domains) const;
  /// Draws a machine with the settings of `with`; throws a std::logic_error if there is none.
  Cell draw_cell(std::mt19937& random, std::span<const std::string> with = {});

  /// True if the factor's conditions hold in the row.
  bool is_read(const Row& row, std::size_t factor) const;
  /// True if some factor's conditions name this factor.
  bool is_switch(std::size_t factor) const { return is_switch_[factor]; }
  /// True if the row contains levels that are known to be refused together.
  bool known_refused(const Row& row) const { return find_refusal(row) != nullptr; }
  /// Asks the validator, and learns from a refusal.
  bool accepts(const Row& row);
  /// Levels that no machine has: `key=value`.
  std::vector<std::string> levels_never_accepted() const;
  bool is_never_accepted(std::size_t factor, int level) const;

  std::vector<std::string> assignments(const Row& row) const;
  Cell cell(const Row& row) const;

 private:
  struct Level {
    std::size_t factor;
    int level;
  };
  using Refusal = std::vector<Level>;
  /// Levels that satisfy a condition of the form `key=value` or `key!=value`.
  struct Condition {
    std::size_t factor;
    std::vector<int> levels;
  };

  Condition condition(const std::string& text) const;
  bool restrict(Domains& domains, const Condition& to) const;
  const Refusal* find_refusal(const Row& row) const;
  bool is_surely_read(const Domains& domains, std::size_t factor) const;
  /// Removes levels that a known refusal leaves no room for; false if no row is left.
  bool prune(Domains& domains) const;
  /// The key paths that reader and validator complain about, one an issue.
  std::vector<std::string> complaints(const Row& row) const;
  void learn(const Row& refused, const std::vector<std::string>& complaints);
  /// Sets to kAbsent what is not read, and draws levels for what is read and absent.
  void normalise(Row& row, std::mt19937& random, const Domains& domains) const;

  std::vector<Factor> factors_;
  std::vector<std::vector<Condition>> conditions_;      // by factor
  std::vector<nlohmann::json::json_pointer> pointers_;  // to the factors' keys
  std::vector<bool> is_switch_;
  std::vector<Refusal> refusals_;
};

/// The space of machine_factors(), which learns once a process.
MachineSpace& all_machines();

}  // namespace carousel::ringbus
