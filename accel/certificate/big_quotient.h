#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <boost/multiprecision/cpp_int.hpp>

namespace carousel::accel {

/// n / d to within 2^-62 of itself and one rounding: to be shown, never to decide. `d` is not 0.
inline double big_quotient(const boost::multiprecision::cpp_int& n, const boost::multiprecision::cpp_int& d) {
  using Int = boost::multiprecision::cpp_int;
  if (n == 0) return 0;
  const Int top = abs(n), bottom = abs(d);
  const int shift = std::max(0, 64 + static_cast<int>(msb(bottom)) - static_cast<int>(msb(top)));
  const Int quotient = Int(top << shift) / bottom;
  const int drop = std::max(0, static_cast<int>(msb(quotient)) - 63);
  const double size = std::ldexp(static_cast<double>(static_cast<std::uint64_t>(quotient >> drop)), drop - shift);
  return (n < 0) == (d < 0) ? size : -size;
}

}  // namespace carousel::accel
