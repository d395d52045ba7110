#pragma once

namespace carousel::bench {

/// Every kind of link queue inside the native engine, and what counting costs there.
void enter_ring_queues();

}  // namespace carousel::bench
