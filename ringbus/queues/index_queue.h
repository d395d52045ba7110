#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/config/fields/queue_kind.h"

namespace carousel::ringbus {

/// A queue of indices whose design is known when the program runs: a LinkQueue (link_queue.h) behind virtual calls, for
/// things that come some hundred rays at a time.
class IndexQueue {
 public:
  virtual ~IndexQueue() = default;
  virtual bool try_push(std::uint32_t index) = 0;
  virtual bool try_pop(std::uint32_t& index) = 0;
};

std::unique_ptr<IndexQueue> make_index_queue(QueueKind kind, std::size_t capacity);

}  // namespace carousel::ringbus
