#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <OpenImageIO/imageio.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/module/module.h"
#include "modules/pictures/picture_file.h"

namespace carousel::pictures {

MemoryFile::MemoryFile(std::string_view bytes) : descriptor_(memfd_create("picture", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error(std::string("cannot make a file in memory: ") + std::strerror(errno));
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count <= 0) {
      const int why = errno;
      close(descriptor_);
      throw std::runtime_error(std::string("cannot write a file in memory: ") + std::strerror(why));
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

MemoryFile::~MemoryFile() {
  close(descriptor_);
}

std::string MemoryFile::name() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

std::string MemoryFile::bytes() const {
  struct stat status {};
  fstat(descriptor_, &status);
  std::string out(static_cast<std::size_t>(status.st_size), '\0');
  for (std::size_t at = 0; at < out.size();) {
    const ssize_t count = pread(descriptor_, &out[at], out.size() - at, static_cast<off_t>(at));
    if (count <= 0) throw std::runtime_error("cannot read a file in memory");
    at += static_cast<std::size_t>(count);
  }
  return out;
}

namespace {

std::string library() {
  const int version = OIIO::openimageio_version();  // 20407: 2.4.7
  return "OpenImageIO " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100);
}

}  // namespace
}  // namespace carousel::pictures

const carousel::ModuleInfo* carousel_module() {
  using namespace carousel;
  static const scene::PictureModule functions{pictures::write_picture, pictures::writes_picture};
  static const ModuleInfo info{
      .build = module_build(),
      .name = scene::PictureModule::kModule,
      .brings = "textures and pictures of TIFF, DDS, TGA, HDR, PSD, JPEG 2000 and other formats",
      .library = pictures::library,
      .functions = &functions,
      .answer = pictures::read_picture};
  return &info;
}
