#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config/fields/shading.h"
#include "core/config/fields/testers.h"
#include "core/config/fields/workload.h"

namespace carousel::config {

/// The base of a visitor V that asks for what rows say beyond their values: V::rest(path, value) returns what such a
/// row goes on with, for the value of a key and its path. A key in an item of a list,
/// which differs at some places, has the path of the key for the whole machine (T::kRowPath); in_override() tells them
/// apart.
template <class V>
class RowWalk {
 public:
  template <class T, class... Args>
  auto field(std::string_view key, T& value, const Args&...) {
    return self().rest(path_of(key), value);
  }
  template <class T, class... Args>
  auto field_or_auto(std::string_view key, std::optional<T>& value, const Args&...) {
    return self().rest(path_of(key), value);
  }
  /// A number of one resource goes by the key of the whole machine.
  template <class Key, class T>
  auto own_key(const Key& row, T& value) {
    return self().rest(std::string(row.path), value);
  }
  template <class T>
  auto choice(std::string_view key, T& value, const char*) {
    return self().rest(path_of(key), value);
  }
  auto section_or_number(std::string_view key, TesterUnits& value, const char* meaning) {
    section(key, value, meaning);
    return self().rest(path_of(key) + ".units", value.units);
  }
  template <class T>
  void section_or_choice(std::string_view key, T& value, const char* meaning) {
    section(key, value, meaning);
  }
  template <class T>
  void section_or_text(std::string_view key, T& value, const char* meaning) {
    section(key, value, meaning);
  }
  template <class T>
  void section(std::string_view key, T& value, const char*) {
    const std::size_t before = path_.size();
    path_ = path_of(key);
    describe(self(), value);
    path_.resize(before);
  }
  template <class T>
  void section(std::string_view key, std::optional<T>& value, const char* meaning) {
    if (value) section(key, *value, meaning);
  }
  template <class T>
  void list(std::string_view, std::vector<T>& value, const char*) {
    const std::string before = std::exchange(path_, T::kRowPath);
    in_override_ = true;
    for (T& item : value) describe(self(), item);
    in_override_ = false;
    path_ = before;
  }
  template <class E>
  void choices(std::string_view, std::vector<E>&, const char*) {}
  void texts(std::string_view, std::vector<std::string>&, const char*) {}
  void effects(std::string_view, ShadingConfig::Effects&, const char*) {}
  void workload(std::string_view, WorkloadConfig&, const char*) {}
  void vary(std::string_view, std::map<std::string, std::vector<std::string>>&, const char*) {}
  template <class Number, class... Rest>
  void others(std::map<std::string, Number>&, const Rest&...) {}
  template <class T>
  void members(std::map<std::string, T>&, const char*) {}

 protected:
  bool in_override() const { return in_override_; }

 private:
  V& self() { return static_cast<V&>(*this); }
  std::string path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  }

  std::string path_;
  bool in_override_ = false;
};

}  // namespace carousel::config
