#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>

#include "core/costs/costs.h"
#include "core/statistics/counters.h"

namespace carousel {

// A part of the cycle machine declares itself in a header of core/config/parts, by a struct of types, texts and static
// functions. The list of all such parts (core/config/parts.h) is a list of types. Reader, schema, search for the
// bottleneck, wiring, byte ledger, report, energy and area iterate over that list when they are compiled.

/// The area of one part: `size` in the unit that its kAreaMeaning names.
struct PartArea {
  double size = 0, mm2 = 0;
};

/// The energy of all parts of one kind over a run.
struct PartEnergy {
  double events = 0, pj_each = 0;
};

/// The declaration of a part. There is one at each L2, if the keys say that it is built:
///   Keys            struct of its section of the configuration, which its `describe` shows to visitors
///   Counts          struct of its counters, which the part counts and the report shows
///   kSection        name of the section of the configuration and of the report
///   kSwitch         key of the section that decides if the part is built; the other keys matter only then
///   kAbsent         clause that says that it is not built
///   kName           its name in the byte ledger and on the terminal
///   kMeaning, kCountsMeaning, kAreaMeaning, kEnergyMeaning   of the sections of configuration and report
/// and, beside its agent, a function `attach` (ringbus/cycle/parts/attached_part.h) that makes it.
template <class P>
concept PartDeclaration = CounterStruct<typename P::Counts> && std::default_initializable<typename P::Keys> &&
    requires(const typename P::Keys& keys, const typename P::Counts& counts, const Costs& costs) {
  { P::kSection } -> std::convertible_to<const char*>;
  { P::kSwitch } -> std::convertible_to<const char*>;
  { P::kAbsent } -> std::convertible_to<const char*>;
  { P::kName } -> std::convertible_to<const char*>;
  { P::kMeaning } -> std::convertible_to<const char*>;
  { P::kCountsMeaning } -> std::convertible_to<const char*>;
  { P::kAreaMeaning } -> std::convertible_to<const char*>;
  { P::kEnergyMeaning } -> std::convertible_to<const char*>;
  { P::is_built(keys) } -> std::same_as<bool>;
  { P::area(keys, costs) } -> std::same_as<PartArea>;
  { P::energy(counts, keys, costs) } -> std::same_as<PartEnergy>;
};

template <PartDeclaration... P>
struct PartList {
  static constexpr std::size_t kSize = sizeof...(P);
  /// Of<P> for each part.
  template <template <class> class Of>
  using Tuple = std::tuple<Of<P>...>;

  /// Calls `body.operator()<P>(index)` with each part in the order of the list.
  template <class Body>
  static constexpr void for_each(const Body& body) {
    std::size_t index = 0;
    (body.template operator()<P>(index++), ...);
  }
};

namespace part_detail {
template <class P>
using Keys = typename P::Keys;
template <class P>
using Counts = std::optional<typename P::Counts>;
}  // namespace part_detail

/// The section of each part.
template <class List>
struct PartKeys {
  typename List::template Tuple<part_detail::Keys> all;

  template <class P>
  typename P::Keys& of() {
    return std::get<typename P::Keys>(all);
  }
  template <class P>
  const typename P::Keys& of() const {
    return std::get<typename P::Keys>(all);
  }
};

/// The counts of each part over the whole machine; absent where it is not built.
template <class List>
struct PartCounts {
  typename List::template Tuple<part_detail::Counts> all;

  template <class P>
  std::optional<typename P::Counts>& of() {
    return std::get<std::optional<typename P::Counts>>(all);
  }
  template <class P>
  const std::optional<typename P::Counts>& of() const {
    return std::get<std::optional<typename P::Counts>>(all);
  }
  friend bool operator==(const PartCounts&, const PartCounts&) = default;
};

/// A value for each part that is built, by its index in the list.
template <class List, class T>
using PerPart = std::array<std::optional<T>, List::kSize>;

}  // namespace carousel
