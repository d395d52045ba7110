// The one place where tinygltf is compiled. Its warnings are turned off.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#include <nlohmann/json.hpp>  // TINYGLTF_NO_INCLUDE_JSON leaves this to us
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
#pragma GCC diagnostic pop
