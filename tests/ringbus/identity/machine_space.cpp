#include "tests/ringbus/identity/machine_space.h"

#include <algorithm>
#include <functional>
#include <span>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/config/load/load.h"

#ifdef __SANITIZE_THREAD__
extern "C" {  // of libtsan, which no header declares
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
void AnnotateIgnoreWritesBegin(const char* file, int line);
void AnnotateIgnoreWritesEnd(const char* file, int line);
}
#endif

namespace carousel::ringbus {

namespace {

/// As long as it lives, ThreadSanitizer does not watch this thread. Machines are drawn on one, which took nine tenths
/// of the time of tests that draw them.
class Unwatched {
 public:
#ifdef __SANITIZE_THREAD__
  Unwatched() {
    AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
    AnnotateIgnoreWritesBegin(__FILE__, __LINE__);
  }
  ~Unwatched() {
    AnnotateIgnoreWritesEnd(__FILE__, __LINE__);
    AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
  }
#else
  Unwatched() {}  // NOLINT: not defaulted, so that a variable of it is no unused one
#endif
  Unwatched(const Unwatched&) = delete;
  Unwatched& operator=(const Unwatched&) = delete;
};

bool contains(const std::vector<int>& levels, int level) {
  return std::binary_search(levels.begin(), levels.end(), level);
}

int pick(std::mt19937& random, const std::vector<int>& levels) {
  return levels[random() % levels.size()];
}

}  // namespace

MachineSpace::MachineSpace(std::vector<Factor> factors)
    : factors_(std::move(factors)), conditions_(factors_.size()), is_switch_(factors_.size()) {
  for (std::size_t f = 0; f < factors_.size(); ++f)
    for (const std::string& need : factors_[f].needs) {
      conditions_[f].push_back(condition(need));
      if (conditions_[f].back().factor >= f) throw std::logic_error(factors_[f].key + " stands before what it needs");
      is_switch_[conditions_[f].back().factor] = true;
    }
  for (const Factor& factor : factors_) {
    std::string path = "/" + factor.key;
    std::replace(path.begin(), path.end(), '.', '/');
    pointers_.emplace_back(path);
  }
}

MachineSpace::Condition MachineSpace::condition(const std::string& text) const {
  const std::size_t equals = text.find('=');
  const bool unequal = text[equals - 1] == '!';
  const std::string key = text.substr(0, equals - (unequal ? 1 : 0)), value = text.substr(equals + 1);
  for (std::size_t f = 0; f < factors_.size(); ++f) {
    if (factors_[f].key != key) continue;
    Condition out{f, {}};
    for (std::size_t v = 0; v < factors_[f].values.size(); ++v)
      if ((factors_[f].values[v] == value) != unequal) out.levels.push_back(static_cast<int>(v));
    return out;
  }
  throw std::logic_error("no factor for " + text);
}

bool MachineSpace::restrict(Domains& domains, const Condition& to) const {
  std::vector<int>& levels = domains[to.factor];
  std::erase_if(levels, [&](int level) { return !contains(to.levels, level); });
  if (levels.empty()) return false;
  return std::all_of(conditions_[to.factor].begin(), conditions_[to.factor].end(),
                     [&](const Condition& need) { return restrict(domains, need); });
}

Domains MachineSpace::domains(std::span<const std::string> with) const {
  Domains out(factors_.size());
  for (std::size_t f = 0; f < factors_.size(); ++f)
    for (std::size_t v = 0; v < factors_[f].values.size(); ++v) out[f].push_back(static_cast<int>(v));
  for (const std::string& setting : with)
    if (!restrict(out, condition(setting))) return {};
  return out;
}

Domains MachineSpace::domains_of_pair(std::size_t f, int a, std::size_t g, int b) const {
  Domains out = domains();
  return restrict(out, {f, {a}})&& restrict(out, {g, {b}}) ? out : Domains{};
}

bool MachineSpace::is_read(const Row& row, std::size_t factor) const {
  return std::all_of(conditions_[factor].begin(), conditions_[factor].end(),
                     [&](const Condition& need) { return contains(need.levels, row[need.factor]); });
}

void MachineSpace::normalise(Row& row, std::mt19937& random, const Domains& domains) const {
  for (std::size_t f = 0; f < row.size(); ++f) {
    if (!is_read(row, f))
      row[f] = kAbsent;
    else if (row[f] == kAbsent)
      row[f] = pick(random, domains[f]);
  }
}

Row MachineSpace::draw_any(std::mt19937& random, const Domains& domains) const {
  Row row(factors_.size(), kAbsent);
  normalise(row, random, domains);
  return row;
}

bool MachineSpace::is_surely_read(const Domains& domains, std::size_t factor) const {
  return std::all_of(conditions_[factor].begin(), conditions_[factor].end(), [&](const Condition& need) {
    return is_surely_read(domains, need.factor) && std::all_of(domains[need.factor].begin(), domains[need.factor].end(),
                                                               [&](int level) { return contains(need.levels, level); });
  });
}

bool MachineSpace::prune(Domains& domains) const {
  for (bool changed = true; changed;) {
    changed = false;
    for (const Refusal& refusal : refusals_) {
      std::vector<Level> open;
      for (const Level& l : refusal)
        if (domains[l.factor] != std::vector<int>{l.level} || !is_surely_read(domains, l.factor)) open.push_back(l);
      if (open.empty()) return false;
      if (open.size() > 1) continue;
      const auto removed = std::erase(domains[open[0].factor], open[0].level);
      if (domains[open[0].factor].empty() && is_surely_read(domains, open[0].factor)) return false;
      if (domains[open[0].factor].empty())
        domains[open[0].factor] = {open[0].level};  // it has to stay unread
      else
        changed |= removed > 0;
    }
  }
  return true;
}

std::optional<Row> MachineSpace::draw(std::mt19937& random, Domains domains) {
  const Unwatched unwatched;
  for (int attempt = 0; attempt < 50; ++attempt) {  // a row that cannot be repaired says nothing of the others
    if (!prune(domains)) return std::nullopt;
    Row row = draw_any(random, domains);
    for (int repair = 0; repair < 100; ++repair) {
      const Refusal* refused = find_refusal(row);
      if (refused == nullptr) {
        if (accepts(row)) return row;
        if (!prune(domains)) return std::nullopt;  // it has learned a refusal
        continue;
      }
      const std::size_t f = (*refused)[random() % refused->size()].factor;
      row[f] = pick(random, domains[f]);
      normalise(row, random, domains);
    }
  }
  return std::nullopt;
}

Cell MachineSpace::draw_cell(std::mt19937& random, std::span<const std::string> with) {
  const Domains allowed = domains(with);
  for (int attempt = 0; attempt < 5 && !allowed.empty(); ++attempt) {
    if (const std::optional<Row> row = draw(random, allowed)) return cell(*row);
    refusals_.clear();  // one that was believed wrongly leaves nothing to draw
  }
  throw std::logic_error("the validator refuses every machine with these settings");
}

const MachineSpace::Refusal* MachineSpace::find_refusal(const Row& row) const {
  for (const Refusal& refusal : refusals_)
    if (std::all_of(refusal.begin(), refusal.end(), [&](const Level& l) { return row[l.factor] == l.level; }))
      return &refusal;
  return nullptr;
}

std::vector<std::string> MachineSpace::complaints(const Row& row) const {
  std::vector<std::string> keys;
  try {
    (void)cell(row);
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) keys.push_back(issue.key_path);
  }
  return keys;
}

bool MachineSpace::accepts(const Row& row) {
  const std::vector<std::string> found = complaints(row);
  if (!found.empty()) learn(row, found);
  return found.empty();
}

/// A level belongs to the refusal if the complaint goes away with another level of its factor. A combination that other
/// rows show to be accepted after all is not believed: then only the row itself is known to be refused.
void MachineSpace::learn(const Row& refused, const std::vector<std::string>& complaints_of_row) {
  std::mt19937 random(1);
  const std::string& key = complaints_of_row.front();
  const Domains all = domains();
  const auto how_often = [&](const std::vector<std::string>& keys) {
    return std::count(keys.begin(), keys.end(), key);
  };
  const auto before = how_often(complaints_of_row);
  std::vector<std::size_t> read;
  for (std::size_t f = 0; f < refused.size(); ++f)
    if (refused[f] != kAbsent) read.push_back(f);
  /// True if the complaint goes away when all these factors take other levels, each level of each being tried.
  const auto matter = [&](std::span<const std::size_t> factors) {
    std::size_t levels = 0;
    for (const std::size_t f : factors) levels = std::max(levels, all[f].size());
    for (std::size_t step = 1; step < levels; ++step) {
      Row other = refused;
      for (const std::size_t f : factors)
        other[f] = all[f][(static_cast<std::size_t>(refused[f]) + step) % all[f].size()];
      normalise(other, random, all);
      if (how_often(complaints(other)) < before) return true;
    }
    return false;
  };
  Refusal together;
  Domains with_these = all;
  /// Most factors have no part in a refusal, and eight of them are found so at once.
  const std::function<void(std::span<const std::size_t>)> narrow = [&](std::span<const std::size_t> factors) {
    if (!matter(factors)) return;
    if (factors.size() > 1) {
      narrow(factors.first(factors.size() / 2));
      narrow(factors.subspan(factors.size() / 2));
      return;
    }
    const std::size_t f = factors[0];
    together.push_back({f, refused[f]});
    with_these[f] = {refused[f]};
  };
  constexpr std::size_t kAtOnce = 8;
  for (std::size_t i = 0; i < read.size(); i += kAtOnce)
    narrow(std::span(read).subspan(i, std::min(kAtOnce, read.size() - i)));
  bool believed = !together.empty();
  for (int trial = 0; believed && trial < 20; ++trial) {
    const Row other = draw_any(random, with_these);
    const bool holds =
        std::all_of(together.begin(), together.end(), [&](const Level& l) { return other[l.factor] == l.level; });
    believed = !holds || how_often(complaints(other)) > 0;  // most random rows are refused, for other reasons
  }
  if (!believed) {
    together.clear();
    for (std::size_t f = 0; f < refused.size(); ++f)
      if (refused[f] != kAbsent) together.push_back({f, refused[f]});
  }
  refusals_.push_back(std::move(together));
}

bool MachineSpace::is_never_accepted(std::size_t factor, int level) const {
  return std::any_of(refusals_.begin(), refusals_.end(), [&](const Refusal& refusal) {
    return refusal.size() == 1 && refusal[0].factor == factor && refusal[0].level == level;
  });
}

std::vector<std::string> MachineSpace::levels_never_accepted() const {
  std::vector<std::string> out;
  for (const Refusal& refusal : refusals_)
    if (refusal.size() == 1)
      out.push_back(factors_[refusal[0].factor].key + "=" +
                    factors_[refusal[0].factor].values[static_cast<std::size_t>(refusal[0].level)]);
  return out;
}

std::vector<std::string> MachineSpace::assignments(const Row& row) const {
  std::vector<std::string> out;
  for (std::size_t f = 0; f < row.size(); ++f)
    if (row[f] != kAbsent) out.push_back(factors_[f].key + "=" + factors_[f].values[static_cast<std::size_t>(row[f])]);
  return out;
}

Cell MachineSpace::cell(const Row& row) const {
  const Unwatched unwatched;
  Cell cell;
  nlohmann::json keys = nlohmann::json::object();
  for (std::size_t f = 0; f < row.size(); ++f) {
    if (row[f] == kAbsent) continue;
    const std::string &key = factors_[f].key, &value = factors_[f].values[static_cast<std::size_t>(row[f])];
    if (key.starts_with("test."))
      cell.set(key, value);
    else
      keys[pointers_[f]] = nlohmann::json::accept(value) ? nlohmann::json::parse(value) : nlohmann::json(value);
  }
  cell.config = load_config({keys.dump(), "machine.json"}).config;
  cell.threads = static_cast<std::size_t>(cell.config.engine.threads.value_or(1));
  return cell;
}

MachineSpace& all_machines() {
  static MachineSpace space(machine_factors());
  return space;
}

}  // namespace carousel::ringbus
