#pragma once

#include <barrier>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// The state that ranks share where they are threads of one process.
struct RankThreads {
  explicit RankThreads(std::uint32_t ranks) : boxes(ranks), texts(ranks), numbers(ranks), all_here(ranks) {}

  struct Box {
    std::mutex mutex;
    std::deque<std::pair<std::uint32_t, std::vector<std::uint64_t>>> messages;
  };
  std::vector<Box> boxes;  // by the rank that receives
  std::vector<std::string> texts;
  std::vector<std::vector<std::uint64_t>> numbers;
  std::barrier<> all_here;
};

/// A rank that is a thread: for tests that a sanitizer can see through, as it cannot through MPI.
class ThreadTransport final : public Transport {
 public:
  ThreadTransport(RankThreads& all, std::uint32_t rank) : all_(all), rank_(rank) {}

  std::uint32_t rank() const override { return rank_; }
  std::uint32_t ranks() const override { return static_cast<std::uint32_t>(all_.boxes.size()); }
  void send(std::uint32_t to, std::span<const std::uint64_t> words) override {
    const std::lock_guard lock(all_.boxes[to].mutex);
    all_.boxes[to].messages.emplace_back(rank_, std::vector<std::uint64_t>(words.begin(), words.end()));
  }
  std::size_t leaving(std::uint32_t) override { return 0; }
  bool receive(std::uint32_t& from, std::vector<std::uint64_t>& words) override {
    RankThreads::Box& box = all_.boxes[rank_];
    const std::lock_guard lock(box.mutex);
    if (box.messages.empty()) return false;
    from = box.messages.front().first;
    words = std::move(box.messages.front().second);
    box.messages.pop_front();
    return true;
  }
  std::vector<std::string> gather(const std::string& bytes) override {
    all_.texts[rank_] = bytes;
    all_.all_here.arrive_and_wait();
    std::vector<std::string> out = all_.texts;
    all_.all_here.arrive_and_wait();
    return out;
  }
  void sum(std::span<std::uint64_t> numbers) override {
    all_.numbers[rank_].assign(numbers.begin(), numbers.end());
    all_.all_here.arrive_and_wait();
    if (rank_ == 0)
      for (std::uint32_t r = 1; r < ranks(); ++r)
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += all_.numbers[r][i];
    all_.all_here.arrive_and_wait();
  }

 private:
  RankThreads& all_;
  std::uint32_t rank_;
};

}  // namespace carousel::ringbus
