#pragma once

#include <glm/vec4.hpp>

namespace carousel::scene {

/// The unit quaternion (x, y, z, w) on the shorter arc from `a` to `b`, unit quaternions, at the share `t` of it in
/// [0, 1]: glTF specification, appendix C. It needs no function of the C library whose last bit depends on the machine.
glm::dvec4 slerp(const glm::dvec4& a, const glm::dvec4& b, double t);

}  // namespace carousel::scene
