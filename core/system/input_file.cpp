#include "core/system/input_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <streambuf>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "core/system/error.h"
#include "core/system/stop_request.h"

namespace carousel {

/// Opens without waiting for a writer, who is waited for at the first byte.
class InputFile::Buffer : public std::streambuf {
 public:
  explicit Buffer(const std::filesystem::path& file)
      : name_(file.string()), descriptor_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {}
  ~Buffer() override {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  bool is_open() const { return descriptor_ >= 0; }

 protected:
  int_type underflow() override {
    for (;;) {
      wait_for(descriptor_, POLLIN, name_);
      const ssize_t count = ::read(descriptor_, bytes_.data(), bytes_.size());
      if (count > 0) {
        setg(bytes_.data(), bytes_.data(), bytes_.data() + count);
        return traits_type::to_int_type(bytes_[0]);
      }
      if (count == 0) return traits_type::eof();
      if (errno != EINTR && errno != EAGAIN) throw FileError("cannot read " + name_ + ": " + std::strerror(errno));
    }
  }

 private:
  std::string name_;
  int descriptor_;
  std::array<char, 1 << 16> bytes_;
};

InputFile::InputFile(const std::filesystem::path& file) : std::istream(nullptr), buffer_(new Buffer(file)) {
  const int why = errno;
  rdbuf(buffer_.get());          // clears the state
  exceptions(std::ios::badbit);  // exceptions of the buffer reach the reader
  if (!buffer_->is_open()) setstate(std::ios::failbit);
  errno = why;
}

InputFile::~InputFile() = default;

}  // namespace carousel
