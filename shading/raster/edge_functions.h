// Homogeneous edge functions: M. Olano, T. Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", Graphics
// Hardware 1997. No triangle is projected or clipped: a ray from the eye along d passes the triangle P0 P1 P2 (relative
// to the eye) where the three volumes d . (Pj x Pk) have one sign, and these volumes are its vertices' weights.
#pragma once

#include <array>
#include <optional>

#include <glm/geometric.hpp>

#include "core/types/vec.h"

namespace carousel::shading {

class EdgeFunctions {
 public:
  struct Crossing {
    double t, u, v;  ///< along the direction; weights of vertices 1 and 2
    bool front;      ///< the ray sees the vertices counter-clockwise
  };

  /// Vertices relative to the eye.
  explicit EdgeFunctions(const std::array<DVec3, 3>& p)
      : normals_{glm::cross(p[1], p[2]), glm::cross(p[2], p[0]), glm::cross(p[0], p[1])},
        plane_(glm::cross(p[1] - p[0], p[2] - p[0])),
        distance_(glm::dot(plane_, p[0])) {}

  /// The crossing of the line along `direction`, in either direction; edges belong to the triangle. Two triangles that
  /// share an edge evaluate it to the same number with opposite signs (each product and sum rounds alike), so no ray
  /// passes between them.
  std::optional<Crossing> cross(const DVec3& direction) const {
    const double a = glm::dot(direction, normals_[0]);
    const double b = glm::dot(direction, normals_[1]);
    const double c = glm::dot(direction, normals_[2]);
    if (!((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0))) return std::nullopt;
    const double sum = a + b + c, across = glm::dot(plane_, direction);
    if (sum == 0 || across == 0) return std::nullopt;  // edge-on, or without area
    return Crossing{distance_ / across, b / sum, c / sum, across < 0};
  }

 private:
  std::array<DVec3, 3> normals_;
  DVec3 plane_;
  double distance_;
};

}  // namespace carousel::shading
