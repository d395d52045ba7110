#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/statistics/run_features.h"

namespace carousel {

// A struct of counters lists its fields once, in its static function `counters()`. Addition, report.json and its schema
// follow from that list, and a member that the list leaves out does not compile.
//
// A new counter takes three places, here `grazing_boxes` of IntersectionCounts:
//   1. the member:                  std::uint64_t box = 0, ..., grazing_boxes = 0;
//   2. its row in counters():       Counter{"grazing_boxes", &C::grazing_boxes, "boxes", "boxes hit within one ulp"},
//   3. the code that counts it:     counts.grazing_boxes += ...;
// Rows stand in the order of the keys in the report.

/// One row of a counter list: a counter of the struct S, or a number that follows from its counters.
template <class S>
class Counter {
 public:
  using Member = std::uint64_t S::*;
  using Derived = std::uint64_t (S::*)() const;

  constexpr Counter(const char* key, Member counter, const char* unit_of, const char* meaning_of,
                    Shown where = Shown::kAlways)
      : name(key), unit(unit_of), meaning(meaning_of), shown(where), member(counter) {}
  constexpr Counter(const char* key, Derived number, const char* unit_of, const char* meaning_of,
                    Shown where = Shown::kAlways)
      : name(key), unit(unit_of), meaning(meaning_of), shown(where), derived_(number) {}

  constexpr std::uint64_t value(const S& counts) const { return member ? counts.*member : (counts.*derived_)(); }

  const char* name;     ///< key in the report
  const char* unit;     ///< as in the report's schema
  const char* meaning;  ///< likewise; a phrase
  Shown shown;
  Member member = nullptr;  ///< null for a derived number

 private:
  Derived derived_ = nullptr;
};

/// A struct with a counter list of its own; a struct derived from such a struct is none.
template <class S>
concept CounterStruct = requires {
  { S::counters().front() } -> std::convertible_to<Counter<S>>;
};

/// The list of S. It does not compile unless each member of S stands in it.
template <CounterStruct S>
inline constexpr auto kCounters = [] {
  constexpr auto list = S::counters();
  constexpr std::size_t members = [&] {
    std::size_t n = 0;
    for (const Counter<S>& row : list) n += row.member != nullptr;
    return n;
  }();
  static_assert(sizeof(S) == members * sizeof(std::uint64_t), "a counter is missing from the list of its struct");
  return list;
}();

/// Adds every counter.
template <CounterStruct S>
constexpr S& operator+=(S& to, const std::type_identity_t<S>& from) {
  const auto add = [&]<std::size_t I>() {
    constexpr auto member = kCounters<S>[I].member;
    if constexpr (member != nullptr) to.*member += from.*member;
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (add.template operator()<I>(), ...);
  }
  (std::make_index_sequence<kCounters<S>.size()>{});
  return to;
}

/// Describes every counter that every report shows to a visitor of the report: see report/sections/visitor.h.
template <class V, CounterStruct S>
void describe(V& v, const S& counts) {
  for (const Counter<S>& row : kCounters<S>)
    if (row.shown == Shown::kAlways) v.field(row.name, row.value(counts), row.unit, row.meaning);
}

}  // namespace carousel
