#pragma once

#include "core/config/fields/scene.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Gives the Gaussians of a scene the shapes that rays are tested against, which become all its instances: an instance
/// of one unit sphere each, by the number of the Gaussian, or one mesh of kProxyTriangles triangles each, in that
/// order. Harmonics above the configured degree are left out. Both reach a little farther than the Gaussians, so that
/// roundings of the tests leave none out. Nothing changes where there are none. Throws a SceneError with the name
/// `file` if the scene has other shapes as well, or if a Gaussian lies or reaches beyond single precision.
void place_gaussians(Scene& scene, const GaussiansConfig& config, const std::string& file);

}  // namespace carousel::scene
