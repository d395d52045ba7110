#pragma once

#include <atomic>
#include <cstdint>

#include "shading/camera/path_sample.h"
#include "shading/camera/pixel_order.h"

namespace carousel::shading {

/// The paths of a frame, in the order in which they begin, and the counts that tell when the last of their first rays
/// has been handed over. Any thread may call, but for set_sample().
class FramePaths {
 public:
  explicit FramePaths(const PixelOrder& order) : order_(order), count_(order.count()) {}

  /// Only these paths begin, in their order; `sample` must outlive this. Null: all. Before any begins.
  void set_sample(const PathSample* sample) {
    sample_ = sample;
    count_ = sample == nullptr ? order_.count() : sample->count();
  }

  std::uint64_t count() const { return count_; }
  /// Pixel and sample of the path that begins as number `i`. Precondition: i < count().
  PixelSample at(std::uint64_t i) const { return order_.at(ordinal(i)); }
  /// Its ordinal in the frame. Same precondition.
  std::uint64_t ordinal(std::uint64_t i) const { return sample_ == nullptr ? i : sample_->ordinal(i); }

  /// So many further paths have begun, and their rays have been appended to a batch or are held. Returns whether all
  /// paths have begun.
  // Counted after appending, so that a thread that reads the full count knows that no other call is still appending.
  // Acquire and release pair with the same operation of the other workers' calls.
  bool begin(std::uint64_t paths) { return begun_.fetch_add(paths, std::memory_order_acq_rel) + paths == count_; }
  /// A worker holds a ray back, before it calls begin() for the ray's path.
  void hold() { held_.fetch_add(1, std::memory_order_acq_rel); }
  /// A ray that was held back has been appended to a batch.
  // Acquire and release: a thread that reads 0 knows that this ray is in its batch.
  void release() { held_.fetch_sub(1, std::memory_order_acq_rel); }
  /// No ray is held back. When all paths have begun, none will be again.
  bool none_held() const { return held_.load(std::memory_order_acquire) == 0; }

 private:
  PixelOrder order_;
  const PathSample* sample_ = nullptr;
  std::uint64_t count_;
  std::atomic<std::uint64_t> begun_{0}, held_{0};
};

}  // namespace carousel::shading
