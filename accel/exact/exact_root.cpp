#include "accel/exact/exact_root.h"

#include <cmath>

namespace carousel::accel {

namespace {

using Int = Dyadic::Int;

/// A root from below: the number itself if `whole`, else less by under 2^-bits of itself.
struct Root {
  Dyadic below, above;
  bool whole = false;
};
Root root_of(const Dyadic& square, unsigned bits) {
  if (square.sign() == 0) return {Dyadic(), Dyadic(), true};
  const int odd = square.exponent() & 1;
  const Int scaled = square.integer() << (2 * bits + static_cast<unsigned>(odd));
  Int rest;
  const Int root = sqrt(scaled, rest);
  const int exponent = (square.exponent() - odd) / 2 - static_cast<int>(bits);
  return {Dyadic(root, exponent), Dyadic(Int(root + 1), exponent), rest == 0};
}

/// Sign of x + side * sqrt(square).
int sign_of(const Dyadic& x, int side, const Dyadic& square) {
  if (square.sign() == 0) side = 0;
  if (side == 0 || x.sign() == side) return x.sign();
  return x.sign() == 0 ? side : x.sign() * (x * x - square).sign();
}

/// Sign of x + side_p * sqrt(p) + side_q * sqrt(q), by squaring twice.
int sign_of(const Dyadic& x, int side_p, const Dyadic& p, int side_q, const Dyadic& q) {
  if (side_p == 0 || p.sign() == 0) return sign_of(x, side_q, q);
  if (side_q == 0 || q.sign() == 0) return sign_of(x, side_p, p);
  const int roots = side_p == side_q ? side_p : side_p * (p - q).sign();
  if (roots == 0 || x.sign() == roots) return x.sign();
  if (x.sign() == 0) return roots;
  return x.sign() * sign_of(x * x - p - q, -side_p * side_q, Dyadic(4) * p * q);
}

}  // namespace

int ExactRoot::compare(double x) const {
  if (std::isinf(x)) return x > 0 ? -1 : 1;
  return sign_of(rational - Dyadic(x) * denominator, side, square);
}

int ExactRoot::compare(const ExactRoot& other) const {
  return sign_of(rational * other.denominator - other.rational * denominator, side,
                 square * other.denominator * other.denominator, -other.side, other.square * denominator * denominator);
}

Dyadic ExactRoot::numerator(unsigned bits) const {
  if (side == 0) return rational;
  const Dyadic root = root_of(square, bits).below;
  return side > 0 ? rational + root : rational - root;
}

template <class Real>
Real ExactRoot::rounded() const {
  if (side == 0) return rounded_ratio<Real>(rational, denominator);
  // A root that is no fraction is never in the middle between two floats: some number of bits decides.
  for (unsigned bits = 96;; bits *= 2) {
    const Root root = root_of(square, bits);
    const auto at = [&](const Dyadic& r) {
      return rounded_ratio<Real>(side > 0 ? rational + r : rational - r, denominator);
    };
    const Real below = at(root.below);
    if (root.whole || below == at(root.above)) return below;
  }
}

template float ExactRoot::rounded<float>() const;
template double ExactRoot::rounded<double>() const;

}  // namespace carousel::accel
