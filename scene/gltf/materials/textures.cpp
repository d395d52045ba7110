// Khronos glTF 2.0 specification, 5.29 (texture) and 5.26 (sampler); extensions KHR_texture_transform,
// EXT_texture_webp, KHR_texture_basisu.
#include "scene/gltf/materials/textures.h"

namespace carousel::scene {

namespace {

constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648, kNearest = 9728;

Wrap wrap_of(const Json& sampler, const char* key) {
  const int mode = sampler.value(key, 0);
  if (mode == kClampToEdge) return Wrap::kClamp;
  return mode == kMirroredRepeat ? Wrap::kMirror : Wrap::kRepeat;
}

Vec2 pair_in(const Json& object, const char* key, Vec2 fallback) {
  const auto pair = object.find(key);
  return pair == object.end() ? fallback : Vec2((*pair)[0].get<float>(), (*pair)[1].get<float>());
}

const Json* extension_of(const Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return nullptr;
  const auto entry = extensions->find(name);
  return entry == extensions->end() ? nullptr : &*entry;
}

}  // namespace

std::optional<TextureUse> TextureReader::use(const Json& owner, const char* slot, const std::string& path) {
  const auto info = owner.find(slot);
  if (info == owner.end()) return std::nullopt;
  TextureUse out;
  int uv_set = info->value("texCoord", 0);
  if (const Json* transform = extension_of(*info, "KHR_texture_transform")) {
    out.offset = pair_in(*transform, "offset", out.offset);
    out.scale = pair_in(*transform, "scale", out.scale);
    out.rotation = transform->value("rotation", 0.0f);
    uv_set = transform->value("texCoord", uv_set);
  }
  if (uv_set > 1) {
    ++dropped_["with a texture coordinate set beyond 1"];
    return std::nullopt;
  }
  const auto index = (*info)["index"].get<std::size_t>();
  const std::optional<std::size_t> image = image_of(index);
  if (!image) {
    if (extension_of(document_.json["textures"][index], "KHR_texture_basisu") != nullptr) {
      document_.fail(json_path(path, slot),
                     "texture " + std::to_string(index) +
                         " is Basis Universal only (KHR_texture_basisu), which Carousel does not read");
    }
    ++dropped_["without a PNG, JPEG or WebP source"];
    return std::nullopt;
  }
  out.uv_set = static_cast<std::uint8_t>(uv_set);
  out.texture = texture(index, *image);
  return out;
}

void TextureReader::warn_of_dropped_uses(const WarningSink& warn) const {
  if (!warn || dropped_.empty()) return;
  std::string text;
  for (const auto& [reason, count] : dropped_)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + reason;
  warn(document_.file + ": texture uses ignored: " + text);
}

std::optional<std::size_t> TextureReader::image_of(std::size_t texture) {
  const Json& from = document_.json["textures"][texture];
  const Json* webp = extension_of(from, "EXT_texture_webp");
  const Json& named = webp != nullptr && webp->contains("source") ? *webp : from;
  if (!named.contains("source")) return std::nullopt;
  return named["source"].get<std::size_t>();
}

TextureId TextureReader::texture(std::size_t index, std::size_t image) {
  const auto [entry, fresh] = textures_.try_emplace(index, static_cast<std::uint32_t>(scene_.textures.size()));
  if (!fresh) return TextureId(entry->second);
  const auto [id, new_image] = image_ids_.try_emplace(image, static_cast<std::uint32_t>(images_.size()));
  if (new_image) images_.push_back(image);
  Texture to;
  to.image = ImageId(id->second);
  const Json& from = document_.json["textures"][index];
  if (from.contains("sampler")) {
    const Json& sampler = document_.json["samplers"][from["sampler"].get<std::size_t>()];
    to.wrap_u = wrap_of(sampler, "wrapS");
    to.wrap_v = wrap_of(sampler, "wrapT");
    to.linear_filter = sampler.value("magFilter", 0) != kNearest;
  }
  scene_.textures.push_back(to);
  return TextureId(entry->second);
}

}  // namespace carousel::scene
