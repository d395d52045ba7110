#include "core/system/sparse_memory.h"

#include <cstdint>
#include <new>

#include <sys/mman.h>
#include <unistd.h>

namespace carousel {

SparseMemory::SparseMemory(std::size_t bytes) {
  void* const data = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  data_ = static_cast<std::byte*>(data);
  bytes_ = bytes;
}

SparseMemory::~SparseMemory() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

std::size_t SparseMemory::fill(std::byte* begin, std::size_t bytes) {
  if (bytes == 0) return 0;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGE_SIZE));
  const std::uintptr_t offset = reinterpret_cast<std::uintptr_t>(begin) % page;
  const std::size_t whole = (bytes + offset + page - 1) / page * page;
  if (mprotect(begin - offset, whole, PROT_READ | PROT_WRITE) != 0) throw std::bad_alloc();
  return whole;
}

}  // namespace carousel
