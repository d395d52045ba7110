#include "scene/images/png_decode.h"

#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <png.h>

namespace carousel::scene {

namespace {

/// libpng's state and the bytes that it reads. An exception must not pass through libpng, which is C: so `fail` keeps
/// the reason and jumps back to the function that called libpng, and the decoder throws after that.
struct Reader {
  explicit Reader(std::span<const unsigned char> bytes) : rest(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore);
    info = png == nullptr ? nullptr : png_create_info_struct(png);
    if (info == nullptr) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, this, read);
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  static void read(png_structp png, png_bytep out, std::size_t size) {
    auto& self = *static_cast<Reader*>(png_get_io_ptr(png));
    if (size > self.rest.size()) png_error(png, "the data ends early");
    std::memcpy(out, self.rest.data(), size);
    self.rest = self.rest.subspan(size);
  }
  [[noreturn]] static void fail(png_structp png, png_const_charp reason) {
    auto& self = *static_cast<Reader*>(png_get_error_ptr(png));
    std::strncpy(self.reason, reason, sizeof self.reason - 1);
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}

  std::span<const unsigned char> rest;
  png_structp png = nullptr;
  png_infop info = nullptr;
  char reason[128] = {};  // no std::string: a jump runs no destructors
};

/// Between setjmp and a jump lie only libpng's frames and this one, which owns nothing.
bool decode_into(Reader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  png_read_end(reader.png, nullptr);
  return true;
}

/// Reads up to the pixels, and asks for eight bits of red, green, blue and alpha.
bool read_info(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_info(reader.png, reader.info);
  png_set_scale_16(reader.png);
  png_set_expand(reader.png);  // palettes, grey of fewer bits and a transparent colour
  png_set_gray_to_rgb(reader.png);
  png_set_add_alpha(reader.png, 0xff, PNG_FILLER_AFTER);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

}  // namespace

Image decode_png(std::span<const unsigned char> encoded) {
  Reader reader(encoded);
  const auto refuse = [&] { throw std::runtime_error(std::string("broken: ") + reader.reason); };
  if (!read_info(reader)) refuse();
  Image image;
  image.width = png_get_image_width(reader.png, reader.info);
  image.height = png_get_image_height(reader.png, reader.info);
  const std::size_t stride = std::size_t{4} * image.width;
  if (png_get_rowbytes(reader.png, reader.info) != stride) throw std::runtime_error("of an unusable channel count");
  image.rgba.resize(stride * image.height);
  std::vector<png_bytep> rows(image.height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = &image.rgba[y * stride];
  if (!decode_into(reader, rows.data())) refuse();
  return image;
}

}  // namespace carousel::scene
