#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/types/enum_names.h"

namespace carousel {

/// A value that code from outside has added to an enum with kAddedAs. Values are numbered behind those of the table.
struct Added {
  std::string name;
  std::string origin;                ///< the file of the plugin that brought it; empty: this program
  std::shared_ptr<const void> body;  ///< what it does; the enum decides of what type it is
};

/// Keeps a value for the rest of the process, and returns its number among those of `what`. Any thread.
std::size_t add_named(std::string_view what, Added added);
/// The `index`-th value added to `what`, which stays where it is; null if there is none. Any thread.
const Added* added_at(std::string_view what, std::size_t index);

/// How many values have been added to all enums. Any thread.
std::size_t added_in_all();

/// Adds a value to an enum. Two origins may give the same name to different values.
template <class E>
E add_named(Added added) {
  return static_cast<E>(kEnumNames<E>.size() + add_named(kAddedAs<E>, std::move(added)));
}
/// What a value that was added does; null for a value of the table. `Body` is the type that the enum's values have.
template <class Body, class E>
const Body* added_body(E value) {
  const auto number = static_cast<std::size_t>(value);
  if (number < kEnumNames<E>.size()) return nullptr;
  const Added* const added = added_at(kAddedAs<E>, number - kEnumNames<E>.size());
  return added == nullptr ? nullptr : static_cast<const Body*>(added->body.get());
}

/// Tells whether a value is none of the table.
template <class E>
constexpr bool is_added(E value) {
  return static_cast<std::size_t>(value) >= kEnumNames<E>.size();
}

/// Whose names count: those of this program, and those of the plugins of these files.
using Origins = std::span<const std::string>;

/// The values of an enum that have a name: those of the table, then those that were added and that `counts`.
template <class E, class Counts>
std::vector<std::pair<std::string, E>> named_values_if(const Counts& counts) {
  std::vector<std::pair<std::string, E>> out;
  for (const auto& [value, name] : kEnumNames<E>) out.emplace_back(name, value);
  if constexpr (!kAddedAs<E>.empty()) {
    const Added* added = nullptr;
    for (std::size_t i = 0; (added = added_at(kAddedAs<E>, i)) != nullptr; ++i)
      if (counts(*added)) out.emplace_back(added->name, static_cast<E>(kEnumNames<E>.size() + i));
  }
  return out;
}
/// Those of the table, of this program and of the plugins of these files.
template <class E>
std::vector<std::pair<std::string, E>> named_values(Origins origins) {
  return named_values_if<E>([&](const Added& added) {
    return added.origin.empty() || std::find(origins.begin(), origins.end(), added.origin) != origins.end();
  });
}
/// Those of the table and all that have been added.
template <class E>
std::vector<std::pair<std::string, E>> all_named_values() {
  return named_values_if<E>([](const Added&) { return true; });
}

}  // namespace carousel
