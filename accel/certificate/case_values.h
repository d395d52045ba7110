#pragma once

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

#include "accel/certificate/property.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// A case's numbers in the order of its fields.
class CaseWriter {
 public:
  CaseWriter& add(float x) { return values_.push_back(x), *this; }
  CaseWriter& add(const Vec3& v) { return add(v.x).add(v.y).add(v.z); }
  CaseWriter& add(const Mat3& m) { return add(m[0]).add(m[1]).add(m[2]); }
  CaseWriter& add(const Aabb& box) { return add(box.lo).add(box.hi); }
  CaseWriter& add(const scene::Affine& m) { return add(m.linear).add(m.translation); }
  CaseWriter& add(const Ray& ray) { return add(ray.origin).add(ray.direction).add(ray.tmin).add(ray.tmax); }
  CaseValues take() { return std::move(values_); }

 private:
  CaseValues values_;
};

/// The fields that CaseWriter writes of a ray, and then `more`.
inline std::vector<CaseField> ray_and(std::initializer_list<CaseField> more) {
  std::vector<CaseField> fields{{"origin", 3}, {"direction", 3}, {"tmin", 1}, {"tmax", 1}};
  fields.insert(fields.end(), more);
  return fields;
}

class CaseReader {
 public:
  explicit CaseReader(const CaseValues& values) : values_(values) {}

  float number() { return values_[next_++]; }
  Vec3 vector() {
    const float x = number(), y = number(), z = number();
    return {x, y, z};
  }
  Mat3 matrix() {
    const Vec3 a = vector(), b = vector(), c = vector();
    return {a, b, c};
  }
  Aabb box() {
    const Vec3 lo = vector(), hi = vector();
    return {lo, hi};
  }
  scene::Affine placement() {
    const Mat3 linear = matrix();
    return {linear, vector()};
  }
  Ray ray() {
    Ray r;
    r.origin = vector();
    r.direction = vector();
    r.tmin = number();
    r.tmax = number();
    return r;
  }
  bool more() const { return next_ < values_.size(); }
  /// From here to the end.
  bool rest_is_finite() const {
    for (std::size_t i = next_; i < values_.size(); ++i)
      if (!std::isfinite(values_[i])) return false;
    return true;
  }

 private:
  const CaseValues& values_;
  std::size_t next_ = 0;
};

}  // namespace carousel::accel
