#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "ringbus/cycle/shapes/cache/index_pool.h"
#include "ringbus/cycle/shapes/cache/strip_walks.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The requests of a cache's clients of which some lines are not there yet, and the cache's way along the strips that
/// some of them ask for without a length.
class PendingRequests {
 public:
  struct Request {
    std::uint32_t client = 0, tag = 0, lines_missing = 0;
    Cycle ready = 0;          ///< no earlier may it be answered
    std::uint64_t line = 0;   ///< the line that an own cache asks for
    std::uint32_t lines = 1;  ///< lines in the answer
    std::uint32_t push = 0;   ///< of CacheAnswers; 0: the answer is for the client alone
    std::uint32_t walk = 0;   ///< 1 + a strip that ends by its flag; 0: the length was named
  };

  /// `ahead`: lines of a strip that are looked up before its end has been found.
  explicit PendingRequests(std::uint64_t ahead) : walks_(ahead) {}

  /// Returns the number of the request.
  std::uint32_t begin(const Request& request) { return requests_.take(request); }
  const Request& operator[](std::uint32_t index) const { return requests_[index]; }
  /// A line of the request has been looked up, at the end of the cycle before `at`.
  void looked_up(std::uint32_t index, Cycle at) {
    Request& request = requests_[index];
    request.ready = std::max(request.ready, at);
  }
  /// A line of the request will be there `at` this time, or is. Returns whether it is the last.
  bool there(std::uint32_t index, std::uint64_t line, Cycle at) {
    looked_up(index, at);
    Request& request = requests_[index];
    if (request.walk > 0) [[unlikely]]
      walks_.there(request.walk - 1, line, at);
    return --request.lines_missing == 0;
  }
  /// The request is answered.
  void end(std::uint32_t index) { requests_.give_back(index); }

  /// Begins the walk along the strip that the request asks for. Returns its number.
  std::uint32_t begin_walk(std::uint32_t index, std::uint64_t first_line) {
    const std::uint32_t walk = walks_.begin(first_line, requests_[index].lines, index);
    requests_[index].walk = walk + 1;
    return walk;
  }
  StripWalks& walks() { return walks_; }
  const StripWalks& walks() const { return walks_; }

 private:
  IndexPool<Request> requests_;
  StripWalks walks_;
};

}  // namespace carousel::ringbus::cycle
