#pragma once

#include <cstdint>
#include <optional>

namespace carousel::ringbus {

/// A wave of the count that finds the end of a run. It rides the ring of ranks, and each rank adds its own counts.
struct EndToken {
  std::uint64_t wave = 0;  ///< counts the waves
  std::uint64_t sent = 0, received = 0;
  friend bool operator==(const EndToken&, const EndToken&) = default;
};

/// Finds out that all ranks have come to rest and that nothing is under way between them, without a rank that waits for
/// all others (F. Mattern, "Algorithms for distributed termination detection", Distributed Computing 2, 1987, the
/// four-counter method). A rank counts what it has sent and received, and keeps the token while it has work. When
/// two waves in a row have found as much received as sent, and the same in both, nothing was sent between them, and
/// nothing is under way. Rank 0 begins the waves and knows the end. Counts of 64 bits do not come round.
class EndCount {
 public:
  EndCount(std::uint32_t rank, std::uint32_t ranks) : rank_(rank), ranks_(ranks) {
    if (rank == 0) token_ = EndToken{};
  }

  void sent(std::uint64_t items) { sent_ += items; }
  void received(std::uint64_t items) { received_ += items; }
  /// The token has come from the previous rank.
  void take(const EndToken& token) { token_ = token; }

  /// A rank that is at rest calls this, and sends the token that it returns to the next rank. `at_rest`: the rank has
  /// no work and will get none but by messages.
  std::optional<EndToken> pass(bool at_rest) {
    if (!token_ || !at_rest || ended_) return std::nullopt;
    EndToken token = *token_;
    token_.reset();
    if (rank_ == 0) {
      if (token.wave > 0) {
        // The counts of the wave that has come back, against those of the one before.
        ended_ =
            token.sent == token.received && last_ && last_->sent == token.sent && last_->received == token.received;
        if (ended_) return std::nullopt;
        last_ = token;
      }
      token = {token.wave + 1, 0, 0};
      if (ranks_ == 1) {
        token.sent += sent_;
        token.received += received_;
        token_ = token;
        return std::nullopt;
      }
    }
    token.sent += sent_;
    token.received += received_;
    return token;
  }
  /// Rank 0: the end has been found.
  bool ended() const { return ended_; }

 private:
  std::uint32_t rank_, ranks_;
  std::uint64_t sent_ = 0, received_ = 0;
  std::optional<EndToken> token_;  // while it is here
  std::optional<EndToken> last_;   // rank 0: the wave before
  bool ended_ = false;
};

}  // namespace carousel::ringbus
