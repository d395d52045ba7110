#pragma once

#include <span>
#include <string>

#include "core/system/memory_budget.h"
#include "scene/images/image_decode.h"
#include "scene/images/picture_format.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Reads a picture by the module pictures, in a process that starts with the first one and ends with the program. The
/// pixels are as decode_image() has them; floats are clamped to 0 and 1 and rounded to 8 bits, after linear light has
/// become sRGB where the picture is used as colours. Any thread; one picture after another is read. Throws as
/// decode_image() does, ModuleError where the module is missing, and Interrupted.
Image decode_foreign_picture(std::span<const unsigned char> encoded, const PictureFormat& format,
                             const PictureHint& hint, MemoryBudget& memory);

}  // namespace carousel::scene
