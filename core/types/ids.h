#pragma once

#include <compare>
#include <cstdint>

namespace carousel {

/// A 32-bit index that cannot be mixed up with an index of another kind. Absence is std::optional, not -1.
template <class Tag>
struct Id {
  std::uint32_t value = 0;
  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  friend constexpr auto operator<=>(Id, Id) = default;
};

using ResourceId = Id<struct ResourceTag>;
using WorkerId = Id<struct WorkerTag>;
using MeshId = Id<struct MeshTag>;
using MaterialId = Id<struct MaterialTag>;
using TextureId = Id<struct TextureTag>;
using ImageId = Id<struct ImageTag>;

}  // namespace carousel
