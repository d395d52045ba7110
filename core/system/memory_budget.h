#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

namespace carousel {

/// The bytes that a reader of foreign data may allocate. The reader asks before each allocation whose size the data
/// announces, so that a small file that announces much is refused before it costs anything, however dense an honest
/// file may be. Several threads may ask at once.
class MemoryBudget {
 public:
  /// Bytes that go back to the budget when the object ends.
  class Loan {
   public:
    Loan() = default;
    Loan(Loan&& other) noexcept : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}
    Loan& operator=(Loan&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Loan() {
      // Relaxed: the number is all that threads share here.
      if (budget_ != nullptr) budget_->left_.fetch_add(bytes_, std::memory_order_relaxed);
    }

   private:
    friend class MemoryBudget;
    Loan(MemoryBudget* budget, std::uint64_t bytes) : budget_(budget), bytes_(bytes) {}

    MemoryBudget* budget_ = nullptr;
    std::uint64_t bytes_ = 0;
  };

  explicit MemoryBudget(std::uint64_t bytes) : allowed_(bytes), left_(bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  /// The bytes that this process may still take: the rest of its limit (`engine.memory_limit_mib`, `ulimit -d`), or 16
  /// GiB where there is none.
  static std::uint64_t of_process();

  /// Takes bytes for as long as the budget lives. Throws std::length_error, whose text is that of refusal(), if fewer
  /// are left.
  void take(std::uint64_t bytes);
  /// Takes bytes for as long as the result lives, which must not be longer than the budget. Throws as take() does.
  [[nodiscard]] Loan lend(std::uint64_t bytes);

  std::uint64_t left() const { return left_.load(std::memory_order_relaxed); }

 private:
  std::string refusal(std::uint64_t bytes, std::uint64_t left) const;

  std::uint64_t allowed_;
  std::atomic<std::uint64_t> left_;
};

}  // namespace carousel
