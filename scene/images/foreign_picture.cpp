#include "scene/images/foreign_picture.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "core/module/module_process.h"
#include "scene/images/picture_module.h"

namespace carousel::scene {

namespace {

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

}  // namespace

Image decode_foreign_picture(std::span<const unsigned char> encoded, const PictureFormat& format,
                             const PictureHint& hint, MemoryBudget& memory) {
  static std::mutex mutex;
  static ModuleProcess process(PictureModule::kModule);
  const std::lock_guard lock(mutex);
  PictureQuestion question;
  question.memory = memory.left();
  question.format_bytes = static_cast<std::uint32_t>(format.name.size());
  question.name_bytes = static_cast<std::uint32_t>(hint.name.size());
  question.color = hint.color;
  const std::array<std::string_view, 4> parts{
      bytes_of(question), format.name, hint.name, {reinterpret_cast<const char*>(encoded.data()), encoded.size()}};
  Image image;
  image.rgba = process.ask(parts, [&](std::uint64_t bytes) {
    memory.take(bytes - std::min<std::uint64_t>(bytes, sizeof(PictureAnswer)));  // without pixels it takes none
  });
  PictureAnswer answer;
  if (image.rgba.size() < sizeof answer) throw std::runtime_error("broken: the module gave no picture");
  std::memcpy(&answer, image.rgba.data() + image.rgba.size() - sizeof answer, sizeof answer);
  image.rgba.resize(image.rgba.size() - sizeof answer);
  const std::uint64_t pixels = std::uint64_t{answer.width} * answer.height;
  if (image.rgba.empty()) throw_if_too_large(answer.width, answer.height, pixels * 4 + answer.work, memory);
  if (pixels == 0 || image.rgba.size() / 4 != pixels) throw std::runtime_error("broken: the module gave no picture");
  image.width = answer.width;
  image.height = answer.height;
  return image;
}

}  // namespace carousel::scene
