#pragma once

#include <cstdint>

#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// A cache's end of the channels of a client.
struct CacheClient {
  Channel<FetchRequest>* requests = nullptr;
  Channel<FetchAnswer>* answers = nullptr;
  Channel<PushedShapes>* pushed = nullptr;  ///< with `memory.fetch: multicast`
};

/// An L2's end of the channels of a resource's own cache, which asks for lines one by one.
struct OwnCacheClient {
  Channel<std::uint64_t>* requests = nullptr;  ///< line numbers, with kWriteLine and kWholeLine
  Channel<std::uint64_t>* answers = nullptr;
};

}  // namespace carousel::ringbus::cycle
