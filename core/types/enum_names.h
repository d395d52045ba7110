#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace carousel {

template <class E>
struct EnumName {
  E value;
  std::string_view name;
};

/// The one table of an enum's spellings, in the order in which texts list them. It is specialised beside the enum.
template <class E>
inline constexpr std::array<EnumName<E>, 0> kEnumNames{};

/// Makes such a table.
template <class E, std::size_t N>
constexpr std::array<EnumName<E>, N> names(const EnumName<E> (&table)[N]) {
  return std::to_array(table);
}

/// The word for a value of an enum to which code from outside may add values by name (core/types/added_names.h); empty
/// for an enum whose table is all there is. It is specialised beside the enum.
template <class E>
inline constexpr std::string_view kAddedAs{};

/// The name of the `index`-th value that was added; empty if there is none.
std::string_view added_name(std::string_view what, std::size_t index);

/// The spelling of `value`; empty for a value that is neither in the table nor added.
template <class E>
constexpr std::string_view enum_name(E value) {
  for (const auto& entry : kEnumNames<E>)
    if (entry.value == value) return entry.name;
  if constexpr (!kAddedAs<E>.empty())
    return added_name(kAddedAs<E>, static_cast<std::size_t>(value) - kEnumNames<E>.size());
  else
    return {};
}

/// The value of the table that has this spelling.
template <class E>
constexpr std::optional<E> enum_value(std::string_view name) {
  for (const auto& entry : kEnumNames<E>)
    if (entry.name == name) return entry.value;
  return std::nullopt;
}

}  // namespace carousel
