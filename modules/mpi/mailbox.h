#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#define OMPI_SKIP_MPICXX 1  // the C++ bindings, which MPI 3 has dropped
#include <mpi.h>

#include "core/system/error.h"

namespace carousel::ringbus {

/// Messages of a run, signs of life, what all give to all, parts of a sum, the last word.
enum Tag : int { kRun = 1, kLife, kGather, kSum, kBye };

/// The messages of this rank that are under way, out and in. One caller at a time; no call waits.
class Mailbox {
 public:
  explicit Mailbox(std::size_t ranks) : leaving_(ranks) {}

  /// True if a request has been fulfilled, or there is none.
  static bool done(MPI_Request& request) {
    int flag = 0;
    MPI_Test(&request, &flag, MPI_STATUS_IGNORE);
    return flag != 0;
  }

  /// Sends a message; keeps its contents until they have left.
  void post(std::uint32_t to, Tag tag, std::vector<std::uint64_t> words) {
    Leaving& message = leaving_[to].emplace_back(Leaving{std::move(words), {}});
    MPI_Isend(message.words.data(), count_of(message.words.size()), MPI_UINT64_T, static_cast<int>(to), tag,
              MPI_COMM_WORLD, &message.request);
  }
  void post(std::uint32_t to, Tag tag, std::vector<char> bytes) {
    Leaving& message = leaving_[to].emplace_back(Leaving{{}, std::move(bytes)});
    MPI_Isend(message.bytes.data(), count_of(message.bytes.size()), MPI_CHAR, static_cast<int>(to), tag, MPI_COMM_WORLD,
              &message.request);
  }

  /// Messages to a rank that have not left yet.
  std::size_t leaving(std::uint32_t to) {
    std::deque<Leaving>& messages = leaving_[to];
    while (!messages.empty() && done(messages.front().request)) {
      if (spare_.size() < 16) spare_.push_back(std::move(messages.front().words));
      messages.pop_front();
    }
    return messages.size();
  }

  /// A vector whose memory has been used before.
  std::vector<std::uint64_t> spare() {
    if (spare_.empty()) return {};
    std::vector<std::uint64_t> out = std::move(spare_.back());
    spare_.pop_back();
    return out;
  }

  /// True if there is a message; then `coming` is the request of its contents, which go to `into`. `into` is a member,
  /// so that MPI may write there also after somebody has given up waiting.
  template <class Unit>
  bool begin_to_take(int from, Tag tag, std::vector<Unit>& into, MPI_Datatype type) {
    int found = 0, count = 0;
    MPI_Message message;
    MPI_Status status;
    MPI_Improbe(from, tag, MPI_COMM_WORLD, &found, &message, &status);
    if (found == 0) return false;
    MPI_Get_count(&status, type, &count);
    into.resize(static_cast<std::size_t>(count));
    MPI_Imrecv(into.data(), count, type, &message, &coming);
    coming_from = status.MPI_SOURCE;
    return true;
  }

  /// Takes messages without contents, which have come whole.
  template <class Heard>
  void take_empty(Tag tag, const Heard& heard) {
    for (;;) {
      int found = 0;
      MPI_Message message;
      MPI_Status status;
      MPI_Improbe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &found, &message, &status);
      if (found == 0) return;
      MPI_Mrecv(nullptr, 0, MPI_CHAR, &message, MPI_STATUS_IGNORE);
      heard(static_cast<std::size_t>(status.MPI_SOURCE));
    }
  }

  MPI_Request coming = MPI_REQUEST_NULL;  ///< request for the message that is being taken
  int coming_from = 0;                    ///< its sender
  std::vector<std::uint64_t> coming_words;
  std::vector<char> coming_bytes;

 private:
  /// Its memory stays where it is while MPI reads it.
  struct Leaving {
    std::vector<std::uint64_t> words;
    std::vector<char> bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  static int count_of(std::size_t size) {
    if (size > std::numeric_limits<int>::max()) throw SimulationError("a message between ranks is too long for MPI");
    return static_cast<int>(size);
  }

  std::vector<std::deque<Leaving>> leaving_;  // by rank
  std::vector<std::vector<std::uint64_t>> spare_;
};

}  // namespace carousel::ringbus
