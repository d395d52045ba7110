#pragma once

#include <array>
#include <span>
#include <string>

#include "accel/structure/accel.h"
#include "core/config/fields/accuracy.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::accel {

struct BoxAnswer {
  bool hit = false;
  float entry = 0;  ///< valid with `hit`
};

/// The node kernel's answers for up to eight boxes.
std::array<BoxAnswer, kMaxWidth> box_answers(BoxLevel level, const Ray& ray, std::span<const Aabb> boxes);

using Corners = std::array<Vec3, 3>;

/// One leaf of up to sixteen triangles, by itself or below one instance, tested as traversal tests it: every triangle
/// kernel with its boxes, transforms and the order of hits.
class OneLeaf {
 public:
  /// Primitives are numbered as they stand.
  explicit OneLeaf(std::span<const Corners> triangles);

  /// False when the placement has no usable inverse at this level; traversal would bake it.
  bool place(const scene::Affine& world_from_model, TransformLevel level);
  Hit hit(const Ray& ray, const AccuracyConfig& accuracy);

 private:
  Accel accel_;
  Aabb model_;
};

/// "hit, t = ..." with every bit and in decimal, or "missed".
std::string text(const Hit& hit);
std::string text(float x);
std::string text(const Vec3& v);

}  // namespace carousel::accel
