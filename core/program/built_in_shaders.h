#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace carousel {

/// The program that takes the time of our own shading code for a kind of work (kShaderKindNames). Its counts of
/// instructions by class are those of the code (bench/studies/count_operations.py); its branches follow the
/// ray.
std::vector<std::string> built_in_shader(std::size_t kind);

}  // namespace carousel
