#pragma once

#include <utility>

#include "core/types/vec.h"
#include "shading/bsdf/bsdf.h"
#include "shading/bsdf/ggx.h"

namespace carousel::shading {

/// Clearcoat and sheen at one point; directions are local to the shading normal.
struct LayerPoint {
  float coat = 0, coat_roughness = 0;
  Vec3 coat_normal{0, 0, 1};
  Vec3 sheen{0};
  float sheen_roughness = 0;
};

/// The light that the layers reflect, and the share of the light from `wo` that they pass to the base below.
class Layers {
 public:
  Layers(const LayerPoint& point, const Vec3& wo);

  /// Adds the layers' own light to `value`, which is the light of everything below them.
  void add(const Vec3& wi, BsdfValue& value) const;
  /// True, with a direction in `wi`, if `lobe` chooses a layer; otherwise `lobe` is rescaled to [0, 1).
  bool sample(float& lobe, const Vec2& u, Vec3& wi) const;
  bool is_wide(float& lobe, bool& wide) const;

 private:
  bool shared(float& lobe, bool& coat) const;

  LayerPoint point_;
  Vec3 wo_, coat_wo_;
  float coat_alpha_, sheen_alpha_;
  float coat_multiple_;                     // the coat's light reflected several times, / pi
  float below_coat_ = 1, below_ = 1;        // share of light that gets below the coat, below all layers
  float coat_share_ = 0, sheen_share_ = 0;  // probabilities
};

/// glTF's clearcoat over sheen over any base. A layer dims everything below by the share that it reflects towards the
/// viewer, for any direction of the light (Khronos, KHR_materials_clearcoat and KHR_materials_sheen, "layering"). So
/// energy is conserved and a path that starts at the camera is right, but the whole is not reciprocal, though each
/// layer is. With weights of 0 the result equals that of the base to the bit.
template <class Base>
class LayeredBsdf {
 public:
  LayeredBsdf(const LayerPoint& layers, Base base, const Vec3& wo) : layers_(layers, wo), base_(std::move(base)) {}

  BsdfValue evaluate(const Vec3& wi) const {
    BsdfValue value = base_.evaluate(wi);
    layers_.add(wi, value);
    return value;
  }
  Vec3 sample(float lobe, const Vec2& u) const {
    Vec3 wi;
    return layers_.sample(lobe, u, wi) ? wi : base_.sample(lobe, u);
  }
  bool is_wide(float lobe) const {
    bool wide = true;
    return layers_.is_wide(lobe, wide) ? wide : base_.is_wide(lobe);
  }

 private:
  Layers layers_;
  Base base_;
};

}  // namespace carousel::shading
