#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace carousel {

/// A kind of test unit that a resource has.
enum class UnitKind : std::uint8_t { kBox, kTriangle, kPlane, kBundle, kTransform, kProcedural, kAnyHit };

struct UnitKindRow {
  UnitKind kind;
  std::string_view key;  ///< below `testers`
  const char* meaning;
  std::int64_t units, interval_cycles, latency_cycles;  ///< defaults of the configuration
};

/// The one table of the kinds, in the order of the enum and of the configuration.
inline constexpr auto kUnitKinds = std::to_array<UnitKindRow>({
    {UnitKind::kBox, "box", "Units that test a ray against a box.", 8, 1, 4},
    {UnitKind::kTriangle, "triangle", "Units that test a ray against a triangle.", 4, 1, 4},
    {UnitKind::kPlane, "plane", "Units that test a ray against a cull plane.", 8, 1, 4},
    {UnitKind::kBundle, "bundle", "Units that test a bundle of rays against a box.", 1, 1, 4},
    {UnitKind::kTransform, "transform", "Units that bring a ray from world space to model space.", 1, 1, 4},
    {UnitKind::kProcedural, "procedural", "Units that test a ray against a procedural primitive.", 1, 1, 8},
    {UnitKind::kAnyHit, "any_hit_unit", "Units that decide if a non-opaque primitive is hit, with any_hit: inline.", 1,
     1, 8},
});

constexpr std::size_t unit_index(UnitKind kind) {
  return static_cast<std::size_t>(kind);
}

constexpr const UnitKindRow& unit_row(UnitKind kind) {
  return kUnitKinds[unit_index(kind)];
}

static_assert([] {
  for (std::size_t i = 0; i < kUnitKinds.size(); ++i)
    if (unit_index(kUnitKinds[i].kind) != i) return false;
  return true;
}());

/// One T for each kind of unit. A loop over it gives each kind with its T: `for (auto [kind, value] : per_unit)`.
template <class T>
class PerUnit {
 public:
  constexpr T& operator[](UnitKind kind) { return values_[unit_index(kind)]; }
  constexpr const T& operator[](UnitKind kind) const { return values_[unit_index(kind)]; }

  template <class Value>
  struct Item {
    UnitKind kind;
    Value& value;
  };
  template <class Value>
  class Iterator {
   public:
    constexpr Iterator(Value* values, std::size_t index) : values_(values), index_(index) {}
    constexpr Item<Value> operator*() const { return {kUnitKinds[index_].kind, values_[index_]}; }
    constexpr Iterator& operator++() {
      ++index_;
      return *this;
    }
    constexpr bool operator!=(const Iterator& other) const { return index_ != other.index_; }

   private:
    Value* values_;
    std::size_t index_;
  };
  constexpr Iterator<T> begin() { return {values_.data(), 0}; }
  constexpr Iterator<T> end() { return {values_.data(), values_.size()}; }
  constexpr Iterator<const T> begin() const { return {values_.data(), 0}; }
  constexpr Iterator<const T> end() const { return {values_.data(), values_.size()}; }

 private:
  std::array<T, kUnitKinds.size()> values_{};
};

}  // namespace carousel
