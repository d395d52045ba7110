#pragma once

namespace carousel::report {

/// `part / whole`; 0 of nothing is 0, so that no report holds a value that is not a number.
template <class A, class B>
double ratio(A part, B whole) {
  return whole == B{} ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace carousel::report
