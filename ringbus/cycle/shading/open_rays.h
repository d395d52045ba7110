#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace carousel::ringbus::cycle {

/// Counts the rays that have begun and not ended, and bounds them by the slots of the machine.
class OpenRays {
 public:
  /// `slots` are those of all resources; camera rays are made at most `group` at a time.
  OpenRays(std::size_t slots, std::size_t group) : slots_(slots), group_(group) {}

  /// The camera rays that a worker may make now.
  std::size_t room() const {
    const std::uint64_t taken = outstanding_ + making_;
    return taken >= slots_ ? 0 : std::min<std::size_t>(group_, slots_ - taken);
  }
  /// A worker begins to make camera rays.
  void begin_making(std::size_t rays) { making_ += rays; }
  /// A worker has made these.
  void made(std::size_t rays) {
    making_ -= rays;
    caused(rays);
  }
  /// Shaded rays have caused these.
  void caused(std::size_t rays) {
    outstanding_ += rays;
    emitted_ += rays;
  }
  void shaded(std::size_t rays) {
    outstanding_ -= rays;
    completed_ += rays;
  }
  /// A resource has stopped for good.
  void remove_slots(std::size_t slots) { slots_ -= slots; }

  bool none() const { return outstanding_ == 0 && making_ == 0; }
  std::size_t slots() const { return slots_; }
  std::uint64_t outstanding() const { return outstanding_; }
  std::uint64_t emitted() const { return emitted_; }
  std::uint64_t completed() const { return completed_; }

 private:
  std::size_t slots_, group_, making_ = 0;
  std::uint64_t outstanding_ = 0, emitted_ = 0, completed_ = 0;
};

}  // namespace carousel::ringbus::cycle
