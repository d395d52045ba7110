#pragma once

namespace carousel::bench {

/// Measures every kind of link queue inside the native engine, and the cost of counting there.
void enter_ring_queues();

}  // namespace carousel::bench
