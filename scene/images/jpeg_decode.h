#pragma once

#include <cstdint>
#include <span>

#include "scene/model/scene.h"

namespace carousel::scene {

struct JpegHeader {
  std::uint32_t width = 0, height = 0;
};

/// Size of a JPEG picture. Throws std::runtime_error with a reason.
JpegHeader read_jpeg_header(std::span<const unsigned char> encoded);

/// The pixels of the picture; four inks (Adobe's, stored inverted) become RGB as ink times black. Allocates memory for
/// the header's size, which the caller has to check first. Throws std::runtime_error with a reason.
Image decode_jpeg(std::span<const unsigned char> encoded, const JpegHeader& header);

}  // namespace carousel::scene
