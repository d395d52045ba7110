#include "shading/effects/effect_rule.h"

#include "shading/surface/material_properties.h"

namespace carousel::shading {

using scene::Material;

bool has_effect(const EffectRule& rule, const Material& m) {
  return rule.material != nullptr && (!m.unlit || rule.unlit_too) && rule.material(m);
}

bool requires_effect(const EffectRule& rule, const Material& m) {
  return has_effect(rule, m) && (!rule.dielectric_only || may_be_dielectric(m));
}

ShaderParts shader_parts(const Material& m) {
  ShaderParts parts = kNoParts;
  for (const EffectRule& rule : effect_rules())
    if (has_effect(rule, m)) parts = parts | rule.shader;
  if (!may_be_dielectric(m)) parts = static_cast<ShaderParts>(parts & ~kTransmission);  // metal is opaque
  return parts;
}

std::vector<scene::TextureUse> textures_read(const Material& m) {
  std::vector<scene::TextureUse> read;
  for (const EffectRule& rule : effect_rules())
    if (rule.textures != nullptr && (!m.unlit || rule.unlit_too)) rule.textures(m, read);
  return read;
}

}  // namespace carousel::shading
