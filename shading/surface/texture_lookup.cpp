#include "shading/surface/texture_lookup.h"

#include <algorithm>
#include <cmath>

#include "shading/math/srgb.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

std::uint32_t wrapped(std::int64_t i, std::int64_t size, scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::kClamp:
      return static_cast<std::uint32_t>(std::clamp<std::int64_t>(i, 0, size - 1));
    case scene::Wrap::kMirror: {
      std::int64_t m = i % (2 * size);
      if (m < 0) m += 2 * size;
      return static_cast<std::uint32_t>(m < size ? m : 2 * size - 1 - m);
    }
    case scene::Wrap::kRepeat:
      break;
  }
  const std::int64_t m = i % size;
  return static_cast<std::uint32_t>(m < 0 ? m + size : m);
}

namespace {

Vec3 texel(const scene::Image& image, std::uint32_t x, std::uint32_t y, Encoding encoding) {
  const std::uint8_t* p = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
  if (encoding == Encoding::kSrgb) {
    const auto& table = srgb_to_linear();
    return {table[p[0]], table[p[1]], table[p[2]]};
  }
  return Vec3{float(p[0]), float(p[1]), float(p[2])} * (1.0f / 255.0f);
}

float alpha_texel(const scene::Image& image, std::uint32_t x, std::uint32_t y) {
  return float(image.rgba[4 * (std::size_t{y} * image.width + x) + 3]) * (1.0f / 255.0f);
}

/// Coordinates beyond this have no fraction left in float, and would overflow the integers below.
constexpr float kFarthest = 0x1p24f;
bool usable(float x) {
  return x > -kFarthest && x < kFarthest;
}

/// A texel without a value, which is noted.
struct Noted {
  Noted operator*(float) const { return {}; }
  Noted operator+(Noted) const { return {}; }
};

/// The values of `texel(image, x, y)`, filtered by the texture's sampler.
template <class Texel>
auto filtered(const scene::Texture& texture, const scene::Image& image, const Vec2& uv, const Texel& texel) {
  const std::int64_t w = image.width, h = image.height;
  const float x = uv.x * static_cast<float>(w), y = uv.y * static_cast<float>(h);
  if (!usable(x) || !usable(y)) return texel(0u, 0u);

  if (!texture.linear_filter) {
    return texel(wrapped(static_cast<std::int64_t>(std::floor(x)), w, texture.wrap_u),
                 wrapped(static_cast<std::int64_t>(std::floor(y)), h, texture.wrap_v));
  }
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  const float fx = (x - 0.5f) - left, fy = (y - 0.5f) - top;
  const auto ix = static_cast<std::int64_t>(left), iy = static_cast<std::int64_t>(top);
  const std::uint32_t x0 = wrapped(ix, w, texture.wrap_u), x1 = wrapped(ix + 1, w, texture.wrap_u);
  const std::uint32_t y0 = wrapped(iy, h, texture.wrap_v), y1 = wrapped(iy + 1, h, texture.wrap_v);
  const auto upper = texel(x0, y0) * (1.0f - fx) + texel(x1, y0) * fx;
  const auto lower = texel(x0, y1) * (1.0f - fx) + texel(x1, y1) * fx;
  return upper * (1.0f - fy) + lower * fy;
}

}  // namespace

Vec2 transform_uv(const scene::TextureUse& use, const Vec2& uv) {
  const Vec2 scaled = use.scale * uv;
  if (use.rotation == 0.0f) return use.offset + scaled;
  // The extension's matrix, (cos, sin; -sin, cos), turns counter-clockwise as seen with v pointing down.
  const SinCos r = sin_cos_turns(use.rotation * 0.159154943f);
  return use.offset + Vec2{r.cos * scaled.x + r.sin * scaled.y, r.cos * scaled.y - r.sin * scaled.x};
}

Vec3 lookup(const scene::Scene& scene, TextureId id, const Vec2& uv, Encoding encoding) {
  const scene::Texture& texture = scene.textures[id.value];
  const scene::Image& image = scene.images[texture.image.value];
  if (image.width == 0 || image.height == 0) return Vec3{1};
  return filtered(texture, image, uv, [&](std::uint32_t x, std::uint32_t y) { return texel(image, x, y, encoding); });
}

std::vector<std::uint64_t> texels_of(const scene::Scene& scene, TextureId id, const Vec2& uv) {
  const scene::Texture& texture = scene.textures[id.value];
  const scene::Image& image = scene.images[texture.image.value];
  std::vector<std::uint64_t> out;
  if (image.width == 0 || image.height == 0) return out;
  filtered(texture, image, uv, [&](std::uint32_t x, std::uint32_t y) {
    out.push_back(std::uint64_t{y} * image.width + x);
    return Noted{};
  });
  return out;
}

float lookup_alpha(const scene::Scene& scene, TextureId id, const Vec2& uv) {
  const scene::Texture& texture = scene.textures[id.value];
  const scene::Image& image = scene.images[texture.image.value];
  if (image.width == 0 || image.height == 0) return 1.0f;
  return filtered(texture, image, uv, [&](std::uint32_t x, std::uint32_t y) { return alpha_texel(image, x, y); });
}

}  // namespace carousel::shading
