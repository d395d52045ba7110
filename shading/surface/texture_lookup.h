#pragma once

#include <cstdint>
#include <vector>

#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// Encoding of an image's RGB channels; it depends on the use of the image.
enum class Encoding : std::uint8_t { kLinear, kSrgb };

/// KHR_texture_transform: offset + R(rotation) * (scale * uv).
Vec2 transform_uv(const scene::TextureUse& use, const Vec2& uv);

/// The texel that a whole coordinate falls on, of `size` texels.
std::uint32_t wrapped(std::int64_t i, std::int64_t size, scene::Wrap wrap);

/// Filtered RGB at transformed texture coordinates; (0, 0) is the top left of the image. Bilinear or nearest
/// by the texture's sampler, between texel centres, on linear values. An image without pixels is white;
/// coordinates that are not finite read its first texel.
Vec3 lookup(const scene::Scene& scene, TextureId texture, const Vec2& uv, Encoding encoding);

/// The texels that lookup() reads, numbered by rows; none if the image has no pixels.
std::vector<std::uint64_t> texels_of(const scene::Scene& scene, TextureId texture, const Vec2& uv);

/// Looks the alpha channel up in the same way; it is linear in any image.
float lookup_alpha(const scene::Scene& scene, TextureId texture, const Vec2& uv);

}  // namespace carousel::shading
