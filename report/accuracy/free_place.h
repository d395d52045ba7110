#pragma once

#include <vector>

namespace carousel::report {

/// A point of a plot, in its pixels.
struct Place {
  double x = 0, y = 0;
};

/// Finds places for small numbers beside dots, so that none stands on another or on a dot.
class FreePlace {
 public:
  struct Frame {
    double left = 0, top = 0, right = 0, bottom = 0;
  };
  explicit FreePlace(const Frame& frame) : frame_(frame) {}

  void take_dot(double x, double y) { dots_.push_back({x, y}); }
  /// The centre of the nearest free place within the frame, which is then taken. If there is none, the place above.
  Place near(double x, double y);

  /// Half the size of a number of two digits.
  static constexpr double kHalfWidth = 8, kHalfHeight = 7;

 private:
  bool is_free(const Place& place) const;

  Frame frame_;
  std::vector<Place> dots_, numbers_;
};

}  // namespace carousel::report
