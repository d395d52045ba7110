#pragma once

#include "core/types/vec.h"

namespace carousel::shading {

/// Reflectance of a surface under a thin film, seen under `cos_theta` from air: L. Belcour, P. Barla, "A practical
/// extension to microfacet theory for the modeling of varying iridescence", SIGGRAPH 2017, with the two orders of
/// interference and the fitted sensitivities that KHR_materials_iridescence uses. `base_f0` is the reflectance of the
/// surface in air at normal incidence. Linear RGB, each 0 to 1.
Vec3 film_reflectance(float cos_theta, float film_ior, float thickness_nm, const Vec3& base_f0);

/// The reflectance at normal incidence from which Schlick's formula makes `reflectance` under `cos_theta`; 0 to 1.
Vec3 f0_of_reflectance(const Vec3& reflectance, float cos_theta);

}  // namespace carousel::shading
