#include "core/system/memory_budget.h"

#include <algorithm>
#include <stdexcept>

#include "core/system/process_memory.h"

namespace carousel {

namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
constexpr std::uint64_t kWithoutLimit = std::uint64_t{16} << 30;

}  // namespace

std::uint64_t MemoryBudget::of_process() {
  const std::uint64_t limit = data_memory_limit();
  if (limit == 0) return kWithoutLimit;
  return limit - std::min(limit, data_memory_bytes());
}

void MemoryBudget::take(std::uint64_t bytes) {
  std::uint64_t left = left_.load(std::memory_order_relaxed);
  do {
    if (bytes > left) throw std::length_error(refusal(bytes, left));
  } while (!left_.compare_exchange_weak(left, left - bytes, std::memory_order_relaxed));
}

MemoryBudget::Loan MemoryBudget::lend(std::uint64_t bytes) {
  take(bytes);
  return Loan(this, bytes);
}

std::string MemoryBudget::refusal(std::uint64_t bytes, std::uint64_t left) const {
  return "needs " + std::to_string(bytes / kMib + (bytes % kMib != 0 ? 1 : 0)) + " MiB of memory; " +
         std::to_string(left / kMib) + " of " + std::to_string(allowed_ / kMib) +
         " MiB are left (engine.memory_limit_mib)";
}

}  // namespace carousel
