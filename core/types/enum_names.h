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

/// The spelling of `value`; empty for a value outside the table.
template <class E>
constexpr std::string_view enum_name(E value) {
  for (const auto& entry : kEnumNames<E>)
    if (entry.value == value) return entry.name;
  return {};
}

template <class E>
constexpr std::optional<E> enum_value(std::string_view name) {
  for (const auto& entry : kEnumNames<E>)
    if (entry.name == name) return entry.value;
  return std::nullopt;
}

}  // namespace carousel
