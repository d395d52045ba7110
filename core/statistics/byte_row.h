#pragma once

#include <cstdint>
#include <string_view>

namespace carousel {

/// Messages of one kind, over all wires or ports that carry it: a row of the byte ledger. The texts are literals.
struct ByteRow {
  std::string_view what;
  std::string_view from, to;
  std::string_view over;            ///< the wire or port that is occupied
  std::uint64_t width = 0;          ///< bytes a cycle that each such wire or port moves
  std::uint64_t bytes = 0;          ///< that senders counted
  std::uint64_t messages = 0;       ///< likewise
  std::uint64_t bytes_taken = 0;    ///< that receivers counted
  std::uint64_t bytes_waiting = 0;  ///< sent and not taken when the run ended
  friend bool operator==(const ByteRow& a, const ByteRow& b) { return a.bytes == b.bytes && a.messages == b.messages; }
};

}  // namespace carousel
