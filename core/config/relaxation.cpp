#include "core/config/relaxation.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/config/row_walk.h"

namespace carousel {

namespace {

using config::Better;
using config::Relaxed;

void make_better(std::int64_t& value, Better how) {
  switch (how) {
    case Better::kTwice:
      value *= 2;
      break;
    case Better::kTwiceOrOne:
      value = std::max<std::int64_t>(1, 2 * value);
      break;
    case Better::kHalf:
      value = std::max<std::int64_t>(1, value / 2);
      break;
  }
}

/// The visitor of rows that are relaxed. It calls `found(path, class, words before the keys, words behind them,
/// Relaxed, in_override)` for each, and relaxes the value if that returns true.
template <class Found>
class RelaxedRows : public config::RowWalk<RelaxedRows<Found>> {
 public:
  /// `automatic`: the value of the one key that says auto and is relaxed, shading.workers.
  RelaxedRows(Found found, std::int64_t automatic) : found_(std::move(found)), automatic_(automatic) {}

  template <class T>
  struct Rest {
    RelaxedRows& rows;
    std::string path;
    T& value;

    template <class... Args>
    Rest only(const Args&...) const {
      return *this;
    }
    template <class How>
    Rest relax(const char* part, How how, Relaxed relaxed = {}, bool applies = true) const {
      if (applies) rows.apply(path, value, part, how, relaxed);
      return *this;
    }
  };
  template <class T>
  Rest<T> rest(std::string path, T& value) {
    return {*this, std::move(path), value};
  }

  void apply(const std::string& path, std::int64_t& value, const char* part, Better how, Relaxed relaxed) {
    if (found_(path, part, how == Better::kHalf ? "half " : "twice ", how == Better::kTwiceOrOne ? ", or 1" : "",
               relaxed, this->in_override()))
      make_better(value, how);
  }
  void apply(const std::string& path, std::optional<std::int64_t>& value, const char* part, Better how,
             Relaxed relaxed) {
    if (this->in_override() && !value) return;  // it is as in the whole machine, which is relaxed there
    std::int64_t known = value.value_or(automatic_);
    apply(path, known, part, how, relaxed);
    if (known != value.value_or(automatic_)) value = known;
  }
  template <class E>
  void apply(const std::string& path, E& value, const char* part, E how, Relaxed relaxed) {
    static_assert(std::is_enum_v<E>);
    if (found_(path, part, "", ": " + std::string(enum_name(how)), relaxed, this->in_override())) value = how;
  }

 private:
  Found found_;
  std::int64_t automatic_;
};

template <class Found>
void walk(Config& config, Found found) {
  RelaxedRows<Found> rows(std::move(found), shader_workers(config));
  describe(rows, config);
}

/// "a and b"; keys that differ in their middle alone are one, with a star there.
std::string key_list(const std::vector<std::string>& keys) {
  if (keys.size() == 1) return keys[0];
  const auto first = [](std::string_view key) { return key.substr(0, key.find('.')); };
  const auto last = [](std::string_view key) { return key.substr(key.rfind('.')); };
  const bool alike = std::all_of(keys.begin(), keys.end(), [&](const std::string& key) {
    return first(key) == first(keys[0]) && last(key) == last(keys[0]);
  });
  if (alike) return std::string(first(keys[0])) + ".*" + std::string(last(keys[0]));
  std::string out = keys[0];
  for (std::size_t i = 1; i < keys.size(); ++i) out += (i + 1 < keys.size() ? ", " : " and ") + keys[i];
  return out;
}

}  // namespace

std::vector<Relaxation> relaxations(const Config& config, const std::function<bool(const std::string& key)>& feels) {
  struct Words {
    std::string before, after;
  };
  std::vector<Relaxation> out;
  std::vector<Words> words;
  Config copy = config;
  walk(copy, [&](const std::string& path, const char* part, const char* before, const std::string& after, Relaxed how,
                 bool in_override) {
    if (in_override || !feels(path)) return false;
    auto at = std::find_if(out.begin(), out.end(), [&](const Relaxation& one) { return one.part == part; });
    if (at == out.end()) {
      at = out.insert(out.end(), {part, "", {}, how});
      words.push_back({before, after});
    }
    at->keys.push_back(path);
    return false;
  });
  for (std::size_t i = 0; i < out.size(); ++i) out[i].action = words[i].before + key_list(out[i].keys) + words[i].after;
  return out;
}

void relax(Config& config, const Relaxation& relaxation) {
  walk(config, [&](const std::string& path, const auto&...) {
    return std::find(relaxation.keys.begin(), relaxation.keys.end(), path) != relaxation.keys.end();
  });
  // Where all pools of workers name theirs, these are relaxed, and the key of the whole machine stays auto.
  if (const DrawnPools drawn = drawn_pools(config.topology); drawn.pools > 0 && drawn.silent == 0)
    config.shading.workers.reset();
}

}  // namespace carousel
