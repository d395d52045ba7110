#pragma once

#include <cstddef>
#include <exception>
#include <utility>
#include <vector>

#include "core/system/executor.h"

namespace carousel::scene {

/// Calls `read(image)` for all of `images`, on the threads of `executor` if there is one, and then once more, one after
/// another, for those that failed: by themselves they may fit a memory that was too small for all of them. So the error
/// is that of the first in the list that does not, whatever thread came first.
template <class Read>
void read_at_once(Executor* executor, std::vector<std::size_t> images, const Read& read) {
  if (executor != nullptr && images.size() > 1) {
    std::vector<char> failed(images.size(), 0);
    executor->parallel_for(images.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        try {
          read(images[i]);
        } catch (const std::exception&) {
          failed[i] = 1;
        }
      }
    });
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < images.size(); ++i)
      if (failed[i] != 0) left.push_back(images[i]);
    images = std::move(left);
  }
  for (const std::size_t image : images) read(image);
}

}  // namespace carousel::scene
